//! Errors and warnings as values: a stable code, named fields, and the English text next to the code.
//!
//! A message never contains the text of another message: a variable part is a field, which may be a message itself. A catalogue
//! of another language therefore needs only the code and the fields.

use crate::words::number;
use core::fmt;
use std::sync::Arc;

/// The value of a field of a message.
#[derive(Clone, Debug, PartialEq)]
pub enum Field {
    /// A quantity in the unit that the text names.
    Number(f64),
    /// A count, or an index from 0.
    Count(i64),
    /// A name or a text from outside, which is the same in all languages.
    Text(String),
    /// A part of the text, with its own entry in a catalogue.
    Message(AnyMessage),
}

/// A parameter of a shape that a text names: as it is written in a scene, or its replacement if there is no scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Setting {
    /// In a scene: `` `size` ``, or with a value `` `open = "cap"` ``.
    InScene {
        /// The name of the parameter.
        name: &'static str,
        /// The value, as written in a scene.
        value: Option<String>,
    },
    /// The equivalent on a command line, such as `--size`.
    InCall(String),
}

impl Setting {
    /// A parameter without a value.
    pub fn named(name: &'static str) -> Setting {
        Setting::InScene { name, value: None }
    }
    /// A parameter with a value, as written in a scene.
    pub fn with(name: &'static str, value: impl fmt::Display) -> Setting {
        Setting::InScene { name, value: Some(value.to_string()) }
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Setting::InScene { name, value: None } => write!(f, "`{name}`"),
            Setting::InScene { name, value: Some(value) } => write!(f, "`{name} = {value}`"),
            Setting::InCall(option) => f.write_str(option),
        }
    }
}

/// The functions that replace settings and names in a message, for readers who know them by other names.
pub struct Replacing<'r> {
    /// The replacement of a setting.
    pub setting: &'r dyn Fn(&Setting) -> Setting,
    /// The replacement of a name or another text from outside.
    pub name: &'r dyn Fn(&str) -> String,
}

/// An error, a warning, or a part of one.
pub trait Message: std::error::Error + Send + Sync + 'static {
    /// The stable code, such as `model.open_surface`. The code of a part of a text begins with `part.`.
    fn code(&self) -> &'static str;
    /// The name of the variant, which distinguishes texts that share a code.
    fn variant(&self) -> &'static str;
    /// The fields by name, in the order of declaration.
    fn fields(&self) -> Vec<(&'static str, Field)>;
    /// The offending value, as it was written.
    fn value(&self) -> Option<String> {
        None
    }
    /// The parameters of a scene to which the message refers, by their names in the scene file, the most important one first.
    fn parameters(&self) -> Vec<String> {
        parameters_of_parts(self.fields())
    }
    /// The allowed values, in English.
    fn allowed(&self) -> Option<String> {
        None
    }
    /// A hint, in English.
    fn hint(&self) -> Option<String> {
        None
    }
    /// The same message with other settings and names. Returns `None` if no field of the message could contain any.
    fn replaced(&self, _by: &Replacing<'_>) -> Option<AnyMessage> {
        None
    }
    /// The English text with the allowed values and the hint: `text; allowed: …; hint: …`.
    fn in_full(&self) -> String {
        let beside = [("allowed", self.allowed()), ("hint", self.hint())];
        let beside = beside.into_iter().filter_map(|(label, text)| text.map(|text| format!("; {label}: {text}")));
        self.to_string() + &beside.collect::<String>()
    }
}

/// The parameters to which the parts of a message refer.
#[doc(hidden)]
pub fn parameters_of_parts(fields: Vec<(&'static str, Field)>) -> Vec<String> {
    let of = |field| match field {
        Field::Message(part) => part.parameters(),
        _ => Vec::new(),
    };
    fields.into_iter().flat_map(|(_, field)| of(field)).collect()
}

/// The data of a variant of a message that a catalogue needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Variant {
    /// The stable code.
    pub code: &'static str,
    /// The name of the variant.
    pub name: &'static str,
    /// The names of the fields of the variant.
    pub fields: &'static [&'static str],
    /// The English text, the allowed values and the hint, as written in the source. A missing text is empty.
    pub english: [&'static str; 3],
}

/// A message of any type: cloned without copying, equal if code, variant and fields are equal.
#[derive(Clone)]
pub struct AnyMessage(Arc<dyn Message>);

impl<M: Message> From<M> for AnyMessage {
    fn from(message: M) -> AnyMessage {
        AnyMessage(Arc::new(message))
    }
}

/// A text in English only.
#[derive(Debug, thiserror::Error)]
#[error("{english}")]
struct Plain {
    code: &'static str,
    english: String,
}

impl Message for Plain {
    fn code(&self) -> &'static str {
        self.code
    }
    fn variant(&self) -> &'static str {
        "Plain"
    }
    fn fields(&self) -> Vec<(&'static str, Field)> {
        vec![("text", Field::Text(self.english.clone()))]
    }
}

impl AnyMessage {
    /// A message with a text in English only, for a program that adds its own kinds.
    pub fn plain(code: &'static str, english: String) -> AnyMessage {
        AnyMessage::from(Plain { code, english })
    }
}

impl core::ops::Deref for AnyMessage {
    type Target = dyn Message;
    fn deref(&self) -> &(dyn Message + 'static) {
        &*self.0
    }
}

impl PartialEq for AnyMessage {
    fn eq(&self, other: &AnyMessage) -> bool {
        self.code() == other.code() && self.variant() == other.variant() && self.fields() == other.fields()
    }
}

impl fmt::Debug for AnyMessage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(&*self.0, f)
    }
}

impl fmt::Display for AnyMessage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&*self.0, f)
    }
}

impl fmt::Display for Field {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Field::Number(x) => f.write_str(&number(*x)),
            Field::Count(n) => n.fmt(f),
            Field::Text(text) => f.write_str(text),
            Field::Message(message) => message.fmt(f),
        }
    }
}

/// A type that a field of a message may have.
pub trait IntoField: Clone {
    /// The value as a field for catalogues.
    fn field(&self) -> Field;
    /// The same value with other settings and names, if it contains any.
    #[must_use]
    fn replaced(&self, _by: &Replacing<'_>) -> Self {
        self.clone()
    }
}

impl IntoField for Setting {
    fn field(&self) -> Field {
        Field::Text(self.to_string())
    }
    fn replaced(&self, by: &Replacing<'_>) -> Setting {
        (by.setting)(self)
    }
}

impl IntoField for f64 {
    fn field(&self) -> Field {
        Field::Number(*self)
    }
}

macro_rules! counts {
    ($($type:ty)*) => { $(impl IntoField for $type {
        fn field(&self) -> Field {
            i64::try_from(*self).map_or_else(|_| Field::Text(self.to_string()), Field::Count)
        }
    })* };
}
counts!(u8 u16 u32 u64 u128 usize i32 i64 i128);

macro_rules! texts {
    ($($type:ty)*) => { $(impl IntoField for $type {
        fn field(&self) -> Field {
            Field::Text(self.to_string())
        }
    })* };
}
texts!(&'static str char bool);

macro_rules! names {
    ($($type:ty)*) => { $(impl IntoField for $type {
        fn field(&self) -> Field {
            Field::Text(self.to_string())
        }
        fn replaced(&self, by: &Replacing<'_>) -> $type {
            (by.name)(self).into()
        }
    })* };
}
names!(String Box<str>);

macro_rules! lists {
    ($($type:ty)*) => { $(impl IntoField for $type {
        fn field(&self) -> Field {
            Field::Text(format!("{self:?}"))
        }
    })* };
}

/// A position, whose coordinates are rounded like other numbers.
impl<const D: usize> IntoField for [f64; D] {
    fn field(&self) -> Field {
        Field::Text(format!("({})", self.map(number).join(", ")))
    }
}

lists!(Vec<u32> Vec<[u32; 2]> [u32; 2]);

impl IntoField for AnyMessage {
    fn field(&self) -> Field {
        Field::Message(self.clone())
    }
    fn replaced(&self, by: &Replacing<'_>) -> AnyMessage {
        Message::replaced(&*self.0, by).unwrap_or_else(|| self.clone())
    }
}

impl<T: IntoField> IntoField for Box<T> {
    fn field(&self) -> Field {
        T::field(self)
    }
    fn replaced(&self, by: &Replacing<'_>) -> Box<T> {
        Box::new(T::replaced(self, by))
    }
}

/// A missing value is an empty text.
impl<T: IntoField> IntoField for Option<T> {
    fn field(&self) -> Field {
        self.as_ref().map_or_else(|| Field::Text(String::new()), IntoField::field)
    }
    fn replaced(&self, by: &Replacing<'_>) -> Option<T> {
        self.as_ref().map(|value| value.replaced(by))
    }
}

/// The text of a part if there is one, otherwise an empty text.
pub fn if_any<T: fmt::Display>(part: &Option<T>) -> String {
    part.as_ref().map_or_else(String::new, T::to_string)
}

/// Declares errors or warnings: an enum by `thiserror` whose variants have a stable code, typed fields and an English
/// text, as `thiserror` formats it. Variants without fields are written with empty braces.
///
/// `#[value(…)]`, `#[parameters(…)]`, `#[allowed(…)]` and `#[hint(…)]` may follow, in this order: the text of the offending
/// value, the names of the parameters of a scene to which the message refers, and the texts of the allowed values and of the
/// hint. If one of the last two texts is empty, the message has no allowed values or no hint. A message without parameters has
/// the parameters of its parts. A message may be a field of another one, because the macro also implements [`IntoField`].
///
/// ```
/// use opruga_math::words::number;
/// opruga_math::messages! {
///     /// Why springs refuse a body.
///     #[derive(Clone, Debug, PartialEq)]
///     pub enum SpringsError {
///         /// An edge between two nodes at one point; its number.
///         "model.edge_length"
///         #[error("edge {edge} is {} m long", number(*length))]
///         #[value("{length}")] #[parameters("modulus")]
///         #[allowed("> 0")]
///         ShortEdge { edge: u32, length: f64 },
///         /// Nothing to hold springs.
///         "model.no_edges"
///         #[error("the body has no edges")]
///         NoEdges {},
///     }
/// }
/// ```
#[macro_export]
macro_rules! messages {
    ($(
        $(#[$about:meta])*
        $visible:vis enum $name:ident {
            $(
                $(#[doc = $doc:literal])* $code:literal #[error($($text:tt)*)]
                $(#[value($($value:tt)*)])? $(#[parameters($($parameter:expr),+)])? $(#[allowed($($allowed:tt)*)])? $(#[hint($($hint:tt)*)])?
                $variant:ident { $($field:ident: $type:ty),* $(,)? }
            ),* $(,)?
        }
    )*) => { $(
        $(#[$about])*
        #[derive(::thiserror::Error)]
        $visible enum $name {
            $($(#[doc = $doc])* #[error($($text)*)] #[allow(missing_docs, reason = "the text of the variant says what its fields are")]
            $variant { $($field: $type),* },)*
        }
        #[allow(unused_variables, reason = "not every text has every field")]
        impl $crate::message::Message for $name {
            fn code(&self) -> &'static str {
                match self { $($name::$variant { .. } => $code,)* }
            }
            fn variant(&self) -> &'static str {
                match self { $($name::$variant { .. } => stringify!($variant),)* }
            }
            fn fields(&self) -> Vec<(&'static str, $crate::message::Field)> {
                match self {
                    $($name::$variant { $($field),* } => vec![
                        $((stringify!($field), $crate::message::IntoField::field($field))),*
                    ],)*
                }
            }
            fn value(&self) -> Option<String> {
                match self { $($name::$variant { $($field),* } => $crate::text_beside!(as written $($($value)*)?),)* }
            }
            fn parameters(&self) -> Vec<String> {
                match self {
                    $($name::$variant { $($field),* } => $crate::parameters_beside!(self $($($parameter),+)?),)*
                }
            }
            fn allowed(&self) -> Option<String> {
                match self { $($name::$variant { $($field),* } => $crate::text_beside!($($($allowed)*)?),)* }
            }
            fn hint(&self) -> Option<String> {
                match self { $($name::$variant { $($field),* } => $crate::text_beside!($($($hint)*)?),)* }
            }
            fn replaced(&self, by: &$crate::message::Replacing<'_>) -> Option<$crate::message::AnyMessage> {
                Some($crate::message::IntoField::replaced(self, by).into())
            }
        }
        impl $name {
            /// Every variant, for tests and catalogues.
            #[allow(dead_code, reason = "tests and catalogues read it where there are any")]
            $visible const VARIANTS: &'static [$crate::message::Variant] = &[$($crate::message::Variant {
                code: $code,
                name: stringify!($variant),
                fields: &[$(stringify!($field)),*],
                english: [stringify!($($text)*), stringify!($($($allowed)*)?), stringify!($($($hint)*)?)],
            }),*];
        }
        impl $crate::message::IntoField for $name {
            fn field(&self) -> $crate::message::Field {
                $crate::message::Field::Message(self.clone().into())
            }
            fn replaced(&self, by: &$crate::message::Replacing<'_>) -> $name {
                match self {
                    $($name::$variant { $($field),* } => $name::$variant {
                        $($field: $crate::message::IntoField::replaced($field, by)),*
                    },)*
                }
            }
        }
    )* };
}

/// An additional text of a message, if there is one.
#[doc(hidden)]
#[macro_export]
macro_rules! text_beside {
    ($(as written)?) => {
        None
    };
    (as written $($text:tt)*) => {
        Some(format!($($text)*))
    };
    ($($text:tt)*) => {
        Some(format!($($text)*)).filter(|text| !text.is_empty())
    };
}

/// The parameters to which a message refers.
#[doc(hidden)]
#[macro_export]
macro_rules! parameters_beside {
    ($message:ident) => {
        $crate::message::parameters_of_parts($message.fields())
    };
    ($message:ident $($parameter:expr),+) => {
        vec![$($parameter.to_string()),+]
    };
}

/// Declares names of things as parts of messages: an enum without fields, whose variants share a code and have one text each.
///
/// ```
/// opruga_math::terms! {
///     /// What a reader expects.
///     pub enum Expected = "part.expected" { Number = "a number", Name = "a name" }
/// }
/// assert_eq!(Expected::Name.to_string(), "a name");
/// ```
#[macro_export]
macro_rules! terms {
    ($(#[$about:meta])* $visible:vis enum $name:ident = $code:literal { $($variant:ident = $text:literal),* $(,)? }) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, ::thiserror::Error)]
        $visible enum $name {
            $(#[doc = $text] #[error($text)] $variant),*
        }
        impl $crate::message::Message for $name {
            fn code(&self) -> &'static str {
                $code
            }
            fn variant(&self) -> &'static str {
                match self { $($name::$variant => stringify!($variant),)* }
            }
            fn fields(&self) -> Vec<(&'static str, $crate::message::Field)> {
                Vec::new()
            }
        }
        impl $name {
            /// Every variant, for tests and catalogues.
            #[allow(dead_code, reason = "tests and catalogues read it where there are any")]
            $visible const VARIANTS: &'static [$crate::message::Variant] = &[$($crate::message::Variant {
                code: $code,
                name: stringify!($variant),
                fields: &[],
                english: [$text, "", ""],
            }),*];
        }
        impl $crate::message::IntoField for $name {
            fn field(&self) -> $crate::message::Field {
                $crate::message::Field::Message((*self).into())
            }
        }
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    crate::messages! {
        /// Where.
        #[derive(Clone, Debug, PartialEq)]
        enum Place {
            /// A body.
            "part.of_body"
            #[error("body `{name}`")]
            Body { name: String },
        }
        /// What.
        #[derive(Clone, Debug, PartialEq)]
        enum Refusal {
            /// Too short.
            "test.short"
            #[error("edge {edge} of {place} is {} m long", number(*length))]
            #[value("{}", number(*length))]
            #[parameters("modulus", least)]
            #[allowed("more than {least}")]
            Short { edge: u32, length: f64, place: Place, least: u32 },
            /// None.
            "test.none"
            #[error("there are no edges")]
            None {},
            /// Of another.
            "test.of"
            #[error("{part}")]
            Of { part: AnyMessage },
            /// Too large.
            "test.large"
            #[error("the body is too large")]
            #[hint("use {scale}, or a smaller {size}")]
            Large { scale: Setting, size: Setting },
        }
    }

    #[test]
    fn a_message_is_code_fields_and_english() {
        let short = Refusal::Short { edge: 3, length: 0.1 + 0.2, place: Place::Body { name: "ball".into() }, least: 0 };
        let any = AnyMessage::from(short);
        assert_eq!(any.to_string(), "edge 3 of body `ball` is 0.3 m long");
        assert_eq!((any.code(), any.variant()), ("test.short", "Short"));
        let names: Vec<_> = any.fields().into_iter().map(|(name, value)| format!("{name}={value}")).collect();
        assert_eq!(names, ["edge=3", "length=0.3", "place=body `ball`", "least=0"]);
        assert_ne!(any, Refusal::None {}.into());
        let by = Replacing { setting: &Setting::clone, name: &|name| name.replace("ball", "box") };
        let other = IntoField::replaced(&any, &by);
        assert_eq!(other.to_string(), "edge 3 of body `box` is 0.3 m long");
        let [_, _, (_, Field::Message(place)), _] = &other.fields()[..] else { panic!("{other:?}") };
        assert_eq!((place.variant(), place.to_string()), ("Body", "body `box`".into()));
        assert_eq!(any, any.clone());
        assert_eq!((any.value(), any.allowed(), any.hint()), (Some("0.3".into()), Some("more than 0".into()), None));
        assert_eq!(any.in_full(), "edge 3 of body `ball` is 0.3 m long; allowed: more than 0");
        let about = ["modulus".to_string(), "0".into()];
        assert_eq!((any.parameters(), other.parameters()), (about.to_vec(), about.to_vec()));
        assert_eq!(Refusal::Of { part: any }.parameters(), about, "those of its part");
        assert_eq!(Refusal::None {}.parameters(), [""; 0]);
        let [short, none, ..] = Refusal::VARIANTS else { panic!("{:?}", Refusal::VARIANTS) };
        assert_eq!((short.code, short.name, short.english[1]), ("test.short", "Short", "\"more than {least}\""));
        assert_eq!((none.fields, none.english), (&[][..], ["\"there are no edges\"", "", ""]));
    }

    #[test]
    fn settings_are_replaced_in_the_parts_of_a_message_too() {
        let large = Refusal::Large { scale: Setting::with("scale", "0.001"), size: Setting::named("size") };
        let around = AnyMessage::from(Refusal::Of { part: large.clone().into() });
        let option = |setting: &Setting| match setting {
            Setting::InScene { name, value } => {
                Setting::InCall(format!("--{name} {}", value.as_deref().unwrap_or_default()).trim_end().into())
            }
            option => option.clone(),
        };
        let hint = |message: &dyn Message| message.hint().expect("a hint");
        let replaced = IntoField::replaced(&around, &Replacing { setting: &option, name: &str::to_string });
        let [(_, Field::Message(part))] = &replaced.fields()[..] else { panic!("{replaced:?}") };
        assert_eq!(hint(&large), "use `scale = 0.001`, or a smaller `size`");
        assert_eq!(hint(&**part), "use --scale 0.001, or a smaller --size");
        assert_eq!(part.fields()[1], ("size", Field::Text("--size".into())));
    }
}
