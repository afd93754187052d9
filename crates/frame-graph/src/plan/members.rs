//! The members of a port, as a plan lists them.

use super::ResourceId;
use data_file::Name;
use std::ops::Deref;
use std::sync::Arc;

/// Names and resources of the members of a port, read as a slice. A port and all that read the whole of it share one
/// list: most of the links of a large plan allocate nothing.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PlannedMembers(Arc<[(Name, ResourceId)]>);

impl Deref for PlannedMembers {
    type Target = [(Name, ResourceId)];

    fn deref(&self) -> &[(Name, ResourceId)] {
        &self.0
    }
}

impl FromIterator<(Name, ResourceId)> for PlannedMembers {
    fn from_iter<I: IntoIterator<Item = (Name, ResourceId)>>(members: I) -> PlannedMembers {
        PlannedMembers(members.into_iter().collect())
    }
}

impl<'a> IntoIterator for &'a PlannedMembers {
    type Item = &'a (Name, ResourceId);
    type IntoIter = std::slice::Iter<'a, (Name, ResourceId)>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}
