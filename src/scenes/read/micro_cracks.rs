//! `[micro_cracks]` of a scene: many short cracks at random places, the same for the same seed.

use toml::Value;

use super::checks::box_of;
use super::region::{self, BoxKeys, overlap};
use crate::scene::Scene;
use perilife_base::error::{Result, fail_if, input, input_missing};
use perilife_base::input::Quantity;
use perilife_base::keys::{Given, key, number, section};
use perilife_base::units::MM;
use perilife_plate::specimen::geometry::{
    bounding_box, distance, distance_to_polygon, distance_to_segment, edges, segments_touch,
};
use perilife_plate::specimen::{Crack, Point};

/// Draws for one crack before the region counts as full.
const DRAWS: usize = 10_000;
/// Length of the longest where a scene says nothing, mm (Huang, Li, Jin, He and Wang, after Zhu and Ni 2017).
const LENGTH_MAX_MM: f64 = 2.0;

/// A length of such cracks.
const SHORT: Quantity = Quantity { what: "a length", unit: "mm", low: 0.0, high: 1e4, si: MM };
const ANGLE: &str = "an angle in degrees";

perilife_base::keys! {
    pub struct MicroCrackKeys {
        seed: u64 = key("seed", "Seed of all draws");
        count: usize = number("count", "Number of cracks", "a whole number", 1.0, 20_000.0);
        length_min: f64 = key("length_min_mm", "Shortest crack").of(SHORT), or "0" 0.0;
        length_max: f64 = key("length_max_mm", "Longest crack").of(SHORT), or "2" LENGTH_MAX_MM * MM;
        angle_min: f64 = number("angle_min_deg", "Least angle, °: against x", ANGLE, -180.0, 180.0), or "-90" -90.0;
        angle_max: f64 = number("angle_max_deg", "Largest angle, °: against x", ANGLE, -180.0, 180.0), or "90" 90.0;
        regions: Option<Vec<BoxKeys>> = key("regions", "Boxes of the cracks: default the whole plate");
    }
}

/// What the cracks are drawn from: uniform in length, angle against x, and place of the middle.
struct Field {
    lengths: [f64; 2],
    angles: [f64; 2],
    boxes: Vec<(Point, Point)>,
}

/// Reads `[micro_cracks]` and adds the cracks, which have no tips, to the plate.
pub fn put_in(value: &Value, scene: &mut Scene) -> Result<()> {
    let input: MicroCrackKeys = section(value, "micro_cracks")?;
    let count = input.count;
    let field = field(&Given::of(value, "micro_cracks")?, &input, scene)?;
    let kept_clear = kept_clear(scene);
    let mut random = SplitMix64(input.seed);
    let mut placed = Vec::with_capacity(count);
    for i in 0..count {
        let crack =
            (0..DRAWS).map(|_| field.draw(&mut random)).find(|crack| fits(*crack, scene, &kept_clear)).ok_or_else(|| {
                let problem =
                    format!("does not fit: after {i} of them no position is clear of edges, cracks, loads and supports");
                let remedy = "give fewer or shorter ones, or a larger region";
                perilife_base::error::input("micro_cracks.count", count, problem, remedy)
            })?;
        placed.push(crack);
    }
    scene.specimen.cracks.extend(placed);
    Ok(())
}

fn field(all: &Given<'_>, given: &MicroCrackKeys, scene: &Scene) -> Result<Field> {
    let (lengths, angles) = ([given.length_min, given.length_max], [given.angle_min, given.angle_max]);
    let pairs =
        [("length_min_mm", "length_max_mm", lengths.map(|length| length / MM)), ("angle_min_deg", "angle_max_deg", angles)];
    if let Some((key, other, values)) = pairs.into_iter().find(|(.., values)| values[0] > values[1]) {
        return Err(all.refuse(key, format!("is above {other}, {}", values[1]), "use a smaller one"));
    }
    fail_if!(lengths[1] == 0.0, input("micro_cracks.length_max_mm", 0.0, "gives cracks of zero length", "give more than zero"));
    let boxes = match &given.regions {
        None => {
            let [low, high] = bounding_box(&scene.specimen.outline);
            vec![(low, high)]
        }
        Some(regions) if regions.is_empty() => {
            return Err(input_missing("micro_cracks.regions", "is empty", "give boxes, or remove it for the whole plate"));
        }
        Some(regions) => {
            let one =
                |(i, given): (usize, &BoxKeys)| region::box_in(given, &format!("micro_cracks.regions[{i}]"), &scene.specimen);
            regions.iter().enumerate().map(one).collect::<Result<_>>()?
        }
    };
    Ok(Field { lengths, angles: angles.map(f64::to_radians), boxes })
}

impl Field {
    fn draw(&self, random: &mut SplitMix64) -> Crack {
        let area = |(low, high): &(Point, Point)| (high[0] - low[0]) * (high[1] - low[1]);
        let mut place = random.share() * self.boxes.iter().map(area).sum::<f64>();
        // The last box takes what round-off leaves.
        let mut chosen = self.boxes[self.boxes.len() - 1];
        for candidate in &self.boxes {
            if place < area(candidate) {
                chosen = *candidate;
                break;
            }
            place -= area(candidate);
        }
        let (low, high) = chosen;
        let middle = [0, 1].map(|i| low[i] + random.share() * (high[i] - low[i]));
        let within = |range: [f64; 2], share: f64| range[0] + share * (range[1] - range[0]);
        let half = within(self.lengths, random.share()) / 2.0;
        let (sin, cos) = within(self.angles, random.share()).sin_cos();
        Crack::straight([middle[0] - half * cos, middle[1] - half * sin], [middle[0] + half * cos, middle[1] + half * sin])
    }
}

/// Boxes of loads and supports, one horizon wider.
fn kept_clear(scene: &Scene) -> Vec<(Point, Point)> {
    let horizon = scene.model.horizon_ratio * scene.model.spacing;
    let regions = scene.drives.iter().map(|drive| &drive.region).chain(scene.holds.iter().map(|hold| &hold.region));
    let wider = |(low, high): (Point, Point)| (low.map(|x| x - horizon), high.map(|x| x + horizon));
    regions.map(|region| wider(box_of(region, scene))).collect()
}

/// Whether a crack lies in the material, a spacing away from edges, holes and notches, apart from the cracks of the file and from
/// loads and supports. Micro cracks may cross each other.
fn fits(crack: Crack, scene: &Scene, kept_clear: &[(Point, Point)]) -> bool {
    let (specimen, margin) = (&scene.specimen, scene.model.spacing);
    let Crack { from, to, .. } = crack;
    let inside = |p: Point| specimen.contains(p) && distance_to_polygon(p, &specimen.outline) > margin;
    let low = [from[0].min(to[0]), from[1].min(to[1])];
    let high = [from[0].max(to[0]), from[1].max(to[1])];
    let near = |a: Point, b: Point| {
        segments_touch(from, to, a, b)
            || [from, to].iter().any(|p| distance_to_segment(*p, a, b) < margin)
            || [a, b].iter().any(|p| distance_to_segment(*p, from, to) < margin)
    };
    inside(from)
        && inside(to)
        && !edges(&specimen.outline).any(|(a, b)| segments_touch(from, to, a, b))
        && specimen.holes.iter().all(|hole| distance_to_segment(hole.centre, from, to) > hole.radius + margin)
        && !specimen.slots.iter().any(|slot| edges(&slot.corners()).any(|(a, b)| near(a, b)))
        && !specimen.cracks.iter().any(|other| distance(other.from, other.to) > 0.0 && near(other.from, other.to))
        && !kept_clear.iter().any(|(other_low, other_high)| overlap(low, high, *other_low, *other_high))
}

/// Steele, Lea and Flood 2014, Fast splittable pseudorandom number generators, OOPSLA, figure 14: the same numbers on every machine.
#[derive(Debug, Clone)]
pub struct SplitMix64(pub u64);

impl SplitMix64 {
    #[expect(clippy::should_implement_trait, reason = "it never ends")]
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number from 0 to below 1, of 53 bits.
    fn share(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }
}
