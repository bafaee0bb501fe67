//! Verdicts before a memory, as one writes them: `voxel-occlusion+object-cache`.

use std::fmt;
use std::str::FromStr;

use serde::{Serialize, Serializer};

use super::{Method, VerdictKind};

/// Which verdicts are asked; each at most once, in the order of [`VerdictKind::ALL`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct VerdictSet(u8);

impl VerdictSet {
    /// None.
    pub const NONE: Self = Self(0);

    /// Whether it is among them.
    #[must_use]
    pub fn contains(self, kind: VerdictKind) -> bool {
        self.0 & (1 << kind.index()) != 0
    }

    /// The same with one more.
    #[must_use]
    pub fn with(self, kind: VerdictKind) -> Self {
        Self(self.0 | 1 << kind.index())
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self == Self::NONE
    }

    /// All of them, in their order.
    pub fn iter(self) -> impl Iterator<Item = VerdictKind> {
        VerdictKind::ALL.into_iter().filter(move |&kind| self.contains(kind))
    }
}

impl fmt::Display for VerdictSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<&str> = self.iter().map(VerdictKind::name).collect();
        f.write_str(&names.join("+"))
    }
}

impl FromStr for VerdictSet {
    type Err = CombinationError;

    /// Reads nothing as none.
    fn from_str(text: &str) -> Result<Self, CombinationError> {
        if text.is_empty() {
            return Ok(Self::NONE);
        }
        let Combination { verdicts, method } = text.parse()?;
        match method {
            Method::Trace if !verdicts.is_empty() => Ok(verdicts),
            memory => Err(CombinationError::NotAVerdict(memory)),
        }
    }
}

/// What stands before a backend: verdicts, then a memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Combination {
    /// Asked first.
    pub verdicts: VerdictSet,
    /// Asked next; [`Method::Trace`] for none.
    pub method: Method,
}

impl Combination {
    /// Says which names there are.
    #[must_use]
    pub fn names() -> String {
        let list = |names: Vec<&str>| names.join(", ");
        format!(
            "give trace, or verdicts ({}) and at most one memory ({}), joined by +",
            list(VerdictKind::ALL.map(VerdictKind::name).to_vec()),
            list(Method::ALL.iter().skip(1).map(|method| method.name()).collect()),
        )
    }
}

impl From<Method> for Combination {
    fn from(method: Method) -> Self {
        Self { verdicts: VerdictSet::NONE, method }
    }
}

impl From<VerdictKind> for Combination {
    fn from(kind: VerdictKind) -> Self {
        Self { verdicts: VerdictSet::NONE.with(kind), method: Method::Trace }
    }
}

impl fmt::Display for Combination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdicts = self.verdicts.iter().map(VerdictKind::name);
        let memory = self.verdicts.is_empty() || self.method != Method::Trace;
        let parts: Vec<&str> = verdicts.chain(memory.then(|| self.method.name())).collect();
        f.write_str(&parts.join("+"))
    }
}

impl Serialize for Combination {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// Why a combination makes no sense.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CombinationError {
    /// No method has this name.
    Unknown(String),
    /// A second answer would be the first.
    Twice(VerdictKind),
    /// A query consults one memory.
    TwoMemories(Method, Method),
    /// Only verdicts are wanted.
    NotAVerdict(Method),
    /// Nothing can be added to nothing.
    WithTrace,
}

impl CombinationError {
    /// What is wrong, and what to give where that is not all that a combination may be.
    #[must_use]
    pub fn with_advice(&self, advice: &str) -> String {
        match self {
            Self::Unknown(name) => format!("there is no shadow method '{name}': {advice}"),
            Self::Twice(kind) => {
                format!("{kind} twice: it would pass on what it passed on before; {advice}")
            }
            Self::TwoMemories(first, second) => {
                format!(
                    "{first} and {second} are both memories, and a query consults one; {advice}"
                )
            }
            Self::NotAVerdict(memory) => format!("{memory} is no verdict; {advice}"),
            Self::WithTrace => format!(
                "trace is the backend alone, so nothing goes with it: leave out 'trace'; {advice}"
            ),
        }
    }
}

impl fmt::Display for CombinationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.with_advice(&Combination::names()))
    }
}

impl FromStr for Combination {
    type Err = CombinationError;

    fn from_str(text: &str) -> Result<Self, CombinationError> {
        let mut verdicts = VerdictSet::NONE;
        let mut memory = None;
        for part in text.split('+').map(str::trim) {
            let verdict = VerdictKind::ALL.into_iter().find(|kind| kind.name() == part);
            let method = Method::ALL.into_iter().find(|method| method.name() == part);
            match (verdict, method, memory) {
                (Some(kind), ..) if verdicts.contains(kind) => {
                    return Err(CombinationError::Twice(kind));
                }
                (Some(kind), ..) => verdicts = verdicts.with(kind),
                (None, Some(Method::Trace), _) if text.contains('+') => {
                    return Err(CombinationError::WithTrace);
                }
                (None, Some(method), Some(other)) => {
                    return Err(CombinationError::TwoMemories(other, method));
                }
                (None, Some(method), None) => memory = Some(method),
                (None, None, _) => return Err(CombinationError::Unknown(part.to_owned())),
            }
        }
        Ok(Self { verdicts, method: memory.unwrap_or_default() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(text: &str) -> String {
        let refusal = text.parse::<Combination>().unwrap_err().to_string();
        assert!(!refusal.contains('\n') && refusal.contains("cache-tree"), "{refusal}");
        refusal
    }

    #[test]
    fn every_name_is_read_as_it_is_written() {
        for method in Method::ALL {
            let combination = Combination::from(method);
            assert_eq!(combination.to_string().parse(), Ok(combination));
        }
        for kind in VerdictKind::ALL {
            for method in Method::ALL {
                let combination = Combination { method, ..kind.into() };
                assert_eq!(combination.to_string().parse(), Ok(combination));
            }
        }
    }

    #[test]
    fn a_combination_that_makes_no_sense_is_refused_with_the_reason() {
        assert!(refusal("object-cache+woo").contains("object-cache and woo are both memories"));
        assert!(refusal("trace+cache-tree").contains("trace is the backend alone"));
        assert!(refusal("cache-tree+trace").contains("trace is the backend alone"));
        assert!(refusal("cache").contains("there is no shadow method 'cache'"));
        assert!(refusal("cache-tree+").contains("there is no shadow method ''"));
        let memory = "cache-tree".parse::<VerdictSet>().unwrap_err().to_string();
        assert!(memory.contains("cache-tree is no verdict"), "{memory}");
        for kind in VerdictKind::ALL {
            assert_eq!(kind.name().parse(), Ok(VerdictSet::NONE.with(kind)));
            assert!(refusal(&format!("{kind}+{kind}")).contains("twice"));
            assert!(refusal(&format!("trace+{kind}")).contains("trace is the backend alone"));
        }
    }
}
