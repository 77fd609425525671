//! Names of topics, scenes and sweeps, as `perilife list` shows them.

use super::chart::{Family, SCENES, Status};
use super::stability::SWEEPS;
use super::{TOPICS, validate};
use perilife_base::kinds::KindLine;

/// Every line: key, name, meaning.
pub fn lines() -> Vec<(String, String, String)> {
    let words = |line: KindLine| (line.key.to_owned(), line.name.to_owned(), line.meaning.to_owned());
    let mut all = Vec::new();
    all.extend(TOPICS.iter().map(|topic| ("verify NAME".to_owned(), topic.name.to_owned(), topic.about.clone())));
    all.extend(validate::built_in().into_iter().map(|(name, title)| ("validate NAME".to_owned(), name, title)));
    all.extend(SCENES.iter().map(|scene| ("chart SCENE".to_owned(), scene.name.clone(), scene.about.clone())));
    all.extend([Family::lines(), Status::lines(), validate::Kind::lines()].into_iter().flatten().map(words));
    all.extend(SWEEPS.iter().map(|sweep| ("stability NAME".to_owned(), sweep.name.clone(), sweep.about.clone())));
    all
}
