//! Errors and warnings as values: a stable code, fields with names, and the English text beside the code.
//!
//! A message never holds a sentence that another message wrote: where a part of it varies, that part is a field, and
//! may be a message itself. So a catalogue of another language needs the code and the fields alone.

use crate::words::number;
use core::fmt;
use std::sync::Arc;

/// The value of a field of a message.
#[derive(Clone, Debug, PartialEq)]
pub enum Field {
    /// A quantity in the unit that the text names.
    Number(f64),
    /// How many, or which one, counted from 0.
    Count(i64),
    /// A name or a text from outside, the same in all languages.
    Text(String),
    /// A part of the text that has its own entry in a catalogue.
    Message(AnyMessage),
}

/// An error, a warning, or a part of one.
pub trait Message: std::error::Error + Send + Sync + 'static {
    /// The stable code, such as `model.open_surface`; that of a part of a text begins with `part.`.
    fn code(&self) -> &'static str;
    /// The name of the variant: tells apart the texts that share a code.
    fn variant(&self) -> &'static str;
    /// The fields by name, in the order of declaration.
    fn fields(&self) -> Vec<(&'static str, Field)>;
}

/// A message of any type: cloned without copying, equal where code, variant and fields are.
#[derive(Clone)]
pub struct AnyMessage(Arc<dyn Message>);

impl<M: Message> From<M> for AnyMessage {
    fn from(message: M) -> AnyMessage {
        AnyMessage(Arc::new(message))
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
pub trait IntoField {
    /// The value, as a catalogue takes it.
    fn field(&self) -> Field;
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
counts!(u8 u16 u32 u64 usize i32 i64);

macro_rules! texts {
    ($($type:ty)*) => { $(impl IntoField for $type {
        fn field(&self) -> Field {
            Field::Text(self.to_string())
        }
    })* };
}
texts!(String &'static str Box<str> char bool);

impl IntoField for AnyMessage {
    fn field(&self) -> Field {
        Field::Message(self.clone())
    }
}

/// What is not there is an empty text.
impl<T: IntoField> IntoField for Option<T> {
    fn field(&self) -> Field {
        self.as_ref().map_or_else(|| Field::Text(String::new()), IntoField::field)
    }
}

/// Declares errors or warnings: an enum by `thiserror` whose variants have a stable code, typed fields and an English
/// text, as `thiserror` formats it. Variants without fields are written with empty braces.
///
/// A message is itself a field: [`IntoField`] is written with it.
///
/// ```
/// use opruga_math::words::number;
/// opruga_math::messages! {
///     /// Why springs refuse a body.
///     #[derive(Clone, Debug, PartialEq)]
///     pub enum SpringsError {
///         /// An edge between two nodes at one point; its number.
///         "model.edge_length"
///         #[error("edge {edge} is {} m long; allowed: > 0", number(*length))]
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
            $($(#[doc = $doc:literal])* $code:literal #[error($($text:tt)*)] $variant:ident { $($field:ident: $type:ty),* $(,)? }),* $(,)?
        }
    )*) => { $(
        $(#[$about])*
        #[derive(::thiserror::Error)]
        $visible enum $name {
            $($(#[doc = $doc])* #[error($($text)*)] #[allow(missing_docs, reason = "the text of the variant says what its fields are")]
            $variant { $($field: $type),* },)*
        }
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
        }
        impl $name {
            /// The code of every variant beside its name, for tests and catalogues.
            #[allow(dead_code, reason = "tests and catalogues read it where there are any")]
            $visible const CODES: &'static [(&'static str, &'static str)] = &[$(($code, stringify!($variant))),*];
        }
        impl $crate::message::IntoField for $name {
            fn field(&self) -> $crate::message::Field {
                $crate::message::Field::Message(self.clone().into())
            }
        }
    )* };
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
            Short { edge: u32, length: f64, place: Place },
            /// None.
            "test.none"
            #[error("there are no edges")]
            None {},
        }
    }

    #[test]
    fn a_message_is_code_fields_and_english() {
        let short = Refusal::Short { edge: 3, length: 0.1 + 0.2, place: Place::Body { name: "ball".into() } };
        let any = AnyMessage::from(short);
        assert_eq!(any.to_string(), "edge 3 of body `ball` is 0.3 m long");
        assert_eq!((any.code(), any.variant()), ("test.short", "Short"));
        let names: Vec<_> = any.fields().into_iter().map(|(name, value)| format!("{name}={value}")).collect();
        assert_eq!(names, ["edge=3", "length=0.3", "place=body `ball`"]);
        assert_ne!(any, Refusal::None {}.into());
        assert_eq!(any, any.clone());
        assert_eq!(Refusal::CODES, [("test.short", "Short"), ("test.none", "None")]);
    }
}
