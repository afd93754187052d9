//! What serde visits in a value: the items of a list, the entries of a map, the fields of a form, a variant of an enum.

use super::{At, De, Refusal, Result};
use crate::grammar::node::Shape;
use serde::de::value::{StrDeserializer, U32Deserializer};
use serde::de::{self, DeserializeSeed, IntoDeserializer, Visitor};

pub(super) struct Items<'r, 's> {
    pub(super) items: std::vec::IntoIter<De<'r, 's>>,
}

impl<'de> de::SeqAccess<'de> for Items<'_, '_> {
    type Error = Refusal;

    fn next_element_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<Option<S::Value>> {
        self.items.next().map(|item| item.give(seed)).transpose()
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.items.len())
    }
}

pub(super) struct Entries<'r, 's> {
    pub(super) entries: std::vec::IntoIter<(De<'r, 's>, De<'r, 's>)>,
    pub(super) value: Option<De<'r, 's>>,
}

impl<'de> de::MapAccess<'de> for Entries<'_, '_> {
    type Error = Refusal;

    fn next_key_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<Option<S::Value>> {
        let Some((key, value)) = self.entries.next() else { return Ok(None) };
        self.value = Some(value);
        key.give(seed).map(Some)
    }

    fn next_value_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<S::Value> {
        self.value.take().expect("a value follows a key").give(seed)
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.entries.len())
    }
}

/// The known fields of a form, in order.
pub(super) struct FieldAccess<'r, 's> {
    pub(super) de: De<'r, 's>,
    pub(super) known: &'static [&'static str],
    pub(super) values: Vec<At<'r>>,
    pub(super) next: usize,
}

impl<'de> de::MapAccess<'de> for FieldAccess<'_, '_> {
    type Error = Refusal;

    fn next_key_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<Option<S::Value>> {
        let Some(name) = self.known.get(self.next) else { return Ok(None) };
        seed.deserialize(StrDeserializer::new(name)).map(Some)
    }

    fn next_value_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<S::Value> {
        let (name, at) = (self.known[self.next], self.values[self.next].clone());
        self.next += 1;
        let form = if matches!(at, At::Absent) { self.de.form } else { None };
        De { form, ..self.de.keyed(name, at) }.give(seed)
    }
}

pub(super) struct SpannedAccess<'r, 's> {
    pub(super) de: Option<De<'r, 's>>,
    pub(super) next: usize,
}

impl<'de> de::SeqAccess<'de> for SpannedAccess<'_, '_> {
    type Error = Refusal;

    fn next_element_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<Option<S::Value>> {
        let Some(de) = &self.de else { return Ok(None) };
        self.next += 1;
        let part: U32Deserializer<Refusal> = match self.next {
            1 => de.place.file.into_deserializer(),
            2 => de.place.start.into_deserializer(),
            3 => de.place.end.into_deserializer(),
            _ => return self.de.take().map(|de| de.give(seed)).transpose(),
        };
        seed.deserialize(part).map(Some)
    }
}

/// A variant of an enum.
pub(super) struct Variant<'r, 's> {
    pub(super) de: De<'r, 's>,
    pub(super) name: &'static str,
    /// What is expected of the whole; none for a shape, whose content is the value itself.
    pub(super) expected: Option<String>,
}

impl<'de, 'r, 's> de::EnumAccess<'de> for Variant<'r, 's> {
    type Error = Refusal;
    type Variant = Self;

    fn variant_seed<S: DeserializeSeed<'de>>(self, seed: S) -> Result<(S::Value, Self)> {
        let name: StrDeserializer<'_, Refusal> = self.name.into_deserializer();
        Ok((seed.deserialize(name)?, self))
    }
}

impl<'r, 's> Variant<'r, 's> {
    /// Returns the values in the brackets of the variant, if there are that many.
    fn items(&self, count: usize) -> Vec<De<'r, 's>> {
        if let At::Value(node) = self.de.at {
            let items = node.items();
            if items.len() == count {
                return items.into_iter().map(|item| self.de.with(At::Value(item))).collect();
            }
            self.de.wrong(self.expected.as_deref().unwrap_or_default());
        }
        vec![self.de.with(At::Bad); count]
    }
}

impl<'de, 'r, 's> de::VariantAccess<'de> for Variant<'r, 's> {
    type Error = Refusal;

    fn unit_variant(self) -> Result<()> {
        if self.expected.is_some() {
            self.items(0);
        }
        Ok(())
    }

    fn newtype_variant_seed<S: DeserializeSeed<'de>>(self, seed: S) -> Result<S::Value> {
        if self.expected.is_none() {
            return self.de.give(seed);
        }
        let is_form = match self.de.at {
            At::Value(node) => matches!(node.shape(), Shape::Form(_)) && node.fields().is_some(),
            _ => false,
        };
        // As the extension `unwrap_variant_newtypes`: the fields of a form are those of its content.
        if is_form {
            return De { form: Some(self.name), expected: self.expected, ..self.de }.give(seed);
        }
        self.items(1).remove(0).give(seed)
    }

    fn tuple_variant<V: Visitor<'de>>(self, len: usize, visitor: V) -> Result<V::Value> {
        visitor.visit_seq(Items { items: self.items(len).into_iter() })
    }

    fn struct_variant<V: Visitor<'de>>(self, known: &'static [&'static str], visitor: V) -> Result<V::Value> {
        let fields = match self.de.at {
            At::Value(node) => node.fields(),
            _ => None,
        };
        if fields.is_none() {
            self.de.wrong(self.expected.as_deref().unwrap_or_default());
        }
        self.de.form(self.name, known, fields, visitor)
    }
}
