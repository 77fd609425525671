//! One macro for the choices an input file can make: a list of kinds gives the enum, its input names,
//! the messages for unknown names and the lines of `perilife list`.
//!
//! To add a kind (a bond law, a solver): a new file `src/<room>/<name>.rs`, its `mod`, and its name and meaning in the
//! list of kinds, after which the compiler names every `match` that must know it. Kinds that describe themselves (growth laws) are a file,
//! its `mod` and its place in their list. Input check, `perilife list` and the tests that loop over kinds find it by themselves.

/// One line of `perilife list`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct KindLine {
    /// Key of the input file, for example `model.bond_law`.
    pub key: &'static str,
    pub name: &'static str,
    pub meaning: &'static str,
}

/// Remedy for a name that is not known: the nearest one, else all of them.
pub fn meant<'n>(near: Option<&str>, known: impl Iterator<Item = &'n str>) -> String {
    let all = || known.collect::<Vec<_>>().join(", ");
    near.map_or_else(
        || format!("use one of: {}", Some(all()).filter(|all| !all.is_empty()).as_deref().unwrap_or("none")),
        |near| format!("did you mean {near}?"),
    )
}

/// What [`kinds!`](crate::kinds!) declares.
pub trait Named: Sized {
    fn lines() -> Vec<KindLine>;
    fn find(text: &str) -> Option<Self>;
}

/// Declares an enum of named choices for one input key, or, of things that have a `name` and a `meaning` and stand in a list, which of them
/// it is.
///
/// Gives `ALL`, `KEY`, `name()`, `meaning()`, `lines()`, `Display`, `FromStr` and serde by name; an unknown name
/// is answered with the known ones.
#[macro_export]
macro_rules! kinds {
    ($($(#[$outer:meta])* pub enum $Kind:ident for $key:literal { $($(#[$inner:meta])* $Variant:ident = $name:literal : $meaning:literal),+ $(,)? })+) => { $(
        $(#[$outer])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum $Kind { $($(#[$inner])* #[doc = $meaning] $Variant),+ }

        impl $Kind {
            /// Every kind, in the order of `perilife list`.
            pub const ALL: &'static [$Kind] = &[$($Kind::$Variant),+];
            /// Key of the input file that takes these names.
            pub const KEY: &'static str = $key;
            pub fn name(self) -> &'static str { match self { $($Kind::$Variant => $name),+ } }
            pub fn meaning(self) -> &'static str { match self { $($Kind::$Variant => $meaning),+ } }
            pub fn all() -> impl Iterator<Item = Self> { Self::ALL.iter().copied() }
        }

        $crate::kinds!(names of $Kind);
    )+ };
    ($(#[$outer:meta])* pub struct $Kind:ident of $Description:ident in $all:ident for $key:literal) => {
        $(#[$outer])*
        #[derive(Clone, Copy)]
        pub struct $Kind(pub &'static $Description);

        impl $Kind {
            /// Key of the input file that takes these names.
            pub const KEY: &'static str = $key;
            pub fn all() -> impl Iterator<Item = Self> { $all.iter().map(|own| $Kind(own)) }
            pub fn name(self) -> &'static str { self.0.name }
            pub fn meaning(self) -> &'static str { self.0.meaning }
        }

        impl PartialEq for $Kind { fn eq(&self, other: &Self) -> bool { self.name() == other.name() } }
        impl std::fmt::Debug for $Kind { fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result { f.write_str(self.name()) } }
        $crate::kinds!(names of $Kind);
    };
    (names of $Kind:ident) => {
        impl $Kind {
            pub fn lines() -> Vec<$crate::kinds::KindLine> {
                Self::all().map(|k| $crate::kinds::KindLine { key: Self::KEY, name: k.name(), meaning: k.meaning() }).collect()
            }
        }

        impl std::fmt::Display for $Kind {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result { f.pad(self.name()) }
        }

        impl std::str::FromStr for $Kind {
            type Err = $crate::error::Error;
            fn from_str(text: &str) -> std::result::Result<Self, Self::Err> {
                <Self as $crate::kinds::Named>::find(text).ok_or_else(|| {
                    let remedy = $crate::kinds::meant(None, Self::all().map(|k| k.name()));
                    $crate::error::input(Self::KEY, format!("\"{text}\""), "unknown kind", remedy)
                })
            }
        }

        impl $crate::kinds::Named for $Kind {
            fn lines() -> Vec<$crate::kinds::KindLine> { Self::lines() }
            fn find(text: &str) -> Option<Self> { Self::all().find(|k| k.name() == text) }
        }

        impl serde::Serialize for $Kind {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> { serializer.serialize_str(self.name()) }
        }

        impl<'de> serde::Deserialize<'de> for $Kind {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
                let text = String::deserialize(deserializer)?;
                text.parse().map_err(|error: $crate::error::Error| serde::de::Error::custom(error))
            }
        }
    };
}
