//! Lists of the items that a recipe can name. One line declares an item, its name in documents and its code.

/// Declares an enum whose variants have names in documents, and optionally rules for each variant.
///
/// A line reads `Variant = "name" => RULES,` where `RULES` implements the list's trait. In a list without a trait, a
/// line reads `Variant = "name",`. The first variant is the default.
#[macro_export]
macro_rules! named_list {
    (
        $(#[$attribute:meta])*
        pub enum $list:ident: $rules:path {
            $($(#[$variant_attribute:meta])* $variant:ident = $name:literal => $value:expr,)+
        }
    ) => {
        $crate::named_list! {
            $(#[$attribute])*
            pub enum $list {
                $($(#[$variant_attribute])* $variant = $name,)+
            }
        }

        impl $list {
            /// The rules of the item.
            pub(crate) fn rules(self) -> &'static dyn $rules {
                match self {
                    $(Self::$variant => &$value,)+
                }
            }
        }
    };
    (
        $(#[$attribute:meta])*
        pub enum $list:ident {
            $($(#[$variant_attribute:meta])* $variant:ident = $name:literal,)+
        }
    ) => {
        $(#[$attribute])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
        pub enum $list {
            $($(#[$variant_attribute])* #[serde(rename = $name)] $variant,)+
        }

        impl $list {
            /// All items, the default first.
            pub const ALL: &'static [Self] = &[$(Self::$variant),+];

            /// The name in documents and on the command line.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name,)+
                }
            }

            /// The item with a name; `None` if the list has no such name.
            #[must_use]
            pub fn from_name(name: &str) -> Option<Self> {
                Self::ALL.iter().copied().find(|item| item.name() == name)
            }
        }

        impl std::fmt::Display for $list {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(self.name())
            }
        }
    };
}
