//! Names for the ways to use Embree, such as `avx2-high-8-coherent`.

use std::fmt;
use std::str::FromStr;

use clap::ValueEnum;

use crate::occlusion::{EmbreeOptions, Isa, PacketWidth, Quality};

/// A way to use Embree, with a name: instruction set, build quality, rays at once, coherence, joined by
/// dashes. A part that is missing is the default's: the best instruction set, medium, 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EmbreeVariant(pub EmbreeOptions);

/// Why a name means no way to use Embree.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum VariantError {
    /// A part is not known.
    #[error(
        "'{0}' is no part of an Embree variant; join with dashes one of each: sse2, sse4.2, avx, avx2, avx512; low, medium, high; 1, 4, 8, 16; coherent. Or say default, or all"
    )]
    Part(String),
    /// One of its kind was named before.
    #[error(
        "'{0}' is one too many of its kind in an Embree variant; give one instruction set, one quality and one width at most"
    )]
    Second(String),
    /// This CPU cannot.
    #[error("this CPU has no {0}; it has {here}", here = available().map(|isa| isa.to_string()).collect::<Vec<_>>().join(", "))]
    Isa(Isa),
    /// These kernels cannot.
    #[error("{isa} has no packets of {width}; {isa} goes up to {widest}", widest = name_of(widest(*isa)))]
    Width {
        /// The instruction set.
        isa: Isa,
        /// Rays at once.
        width: &'static str,
    },
    /// It would say nothing.
    #[error("coherent is said of packets: add 4, 8 or 16")]
    Coherent,
}

/// All widths.
const WIDTHS: [PacketWidth; 4] =
    [PacketWidth::One, PacketWidth::Four, PacketWidth::Eight, PacketWidth::Sixteen];

fn available() -> impl DoubleEndedIterator<Item = Isa> {
    Isa::ALL.into_iter().filter(|isa| isa.is_available())
}

fn name_of(width: PacketWidth) -> &'static str {
    match width {
        PacketWidth::One => "1",
        PacketWidth::Four => "4",
        PacketWidth::Eight => "8",
        PacketWidth::Sixteen => "16",
    }
}

/// The widest packets that an instruction set has kernels for.
fn widest(isa: Isa) -> PacketWidth {
    match isa {
        Isa::Sse2 | Isa::Sse42 => PacketWidth::Four,
        Isa::Avx | Isa::Avx2 => PacketWidth::Eight,
        Isa::Avx512 => PacketWidth::Sixteen,
    }
}

fn place(width: PacketWidth) -> usize {
    WIDTHS.iter().position(|&other| other == width).expect("they are all there")
}

impl EmbreeVariant {
    /// Every one that this CPU has.
    #[must_use]
    pub fn all() -> Vec<Self> {
        let mut all = Vec::new();
        for isa in available() {
            for &quality in Quality::value_variants() {
                for &width in &WIDTHS[..=place(widest(isa))] {
                    let packets = width != PacketWidth::One;
                    for coherent in if packets { &[false, true][..] } else { &[false] } {
                        let isa = Some(isa);
                        let coherent = *coherent;
                        all.push(Self(EmbreeOptions { quality, isa, width, coherent }));
                    }
                }
            }
        }
        all
    }

    /// Every one of the instruction set that Embree itself would choose here, which goes unnamed.
    #[must_use]
    pub fn of_best_isa() -> Vec<Self> {
        let best = available().next_back();
        let unnamed = |Self(options): Self| Self(EmbreeOptions { isa: None, ..options });
        Self::all().into_iter().filter(|variant| variant.0.isa == best).map(unnamed).collect()
    }

    /// The variants of a list on the command line: names, `default` or `all`.
    ///
    /// # Errors
    /// If a name means no way to use Embree here.
    pub fn list(names: &[String]) -> Result<Vec<Self>, VariantError> {
        let mut variants = Vec::new();
        for name in names {
            match &name[..] {
                "all" => variants.extend(Self::all()),
                name => variants.push(name.parse()?),
            }
        }
        Ok(variants)
    }

    fn check(self) -> Result<Self, VariantError> {
        let EmbreeOptions { isa, width, coherent, .. } = self.0;
        if let Some(isa) = isa.filter(|isa| !isa.is_available()) {
            return Err(VariantError::Isa(isa));
        }
        let isa = isa.or(available().next_back()).unwrap_or(Isa::Sse2);
        if place(width) > place(widest(isa)) {
            return Err(VariantError::Width { isa, width: name_of(width) });
        }
        if coherent && width == PacketWidth::One {
            return Err(VariantError::Coherent);
        }
        Ok(self)
    }
}

impl FromStr for EmbreeVariant {
    type Err = VariantError;

    fn from_str(name: &str) -> Result<Self, VariantError> {
        if name == "default" {
            return Ok(Self(EmbreeOptions::default()));
        }
        let (mut isa, mut quality, mut width, mut coherent) = (None, None, None, None);
        for part in name.split('-') {
            let is_second =
                if let Some(named) = Isa::ALL.into_iter().find(|isa| isa.to_string() == part) {
                    isa.replace(named).is_some()
                } else if let Ok(named) = Quality::from_str(part, true) {
                    quality.replace(named).is_some()
                } else if let Some(&named) = WIDTHS.iter().find(|&&width| name_of(width) == part) {
                    width.replace(named).is_some()
                } else if part == "coherent" {
                    coherent.replace(true).is_some()
                } else {
                    return Err(VariantError::Part(part.to_owned()));
                };
            if is_second {
                return Err(VariantError::Second(part.to_owned()));
            }
        }
        let options = EmbreeOptions {
            isa,
            quality: quality.unwrap_or_default(),
            width: width.unwrap_or_default(),
            coherent: coherent.unwrap_or_default(),
        };
        Self(options).check()
    }
}

impl fmt::Display for EmbreeVariant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let EmbreeOptions { quality, isa, width, coherent } = self.0;
        if let Some(isa) = isa {
            write!(f, "{isa}-")?;
        }
        let quality = quality.to_possible_value().expect("every quality has a name");
        write!(f, "{}-{}", quality.get_name(), name_of(width))?;
        if coherent { f.write_str("-coherent") } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_variant_has_one_of_each_kind() {
        for (name, second) in [
            ("low-high", "high"),
            ("8-16", "16"),
            ("sse2-avx2-8", "avx2"),
            ("8-coherent-coherent", "coherent"),
        ] {
            let refused = name.parse::<EmbreeVariant>();
            assert_eq!(refused, Err(VariantError::Second(second.to_owned())), "{name}");
        }
    }

    #[test]
    fn every_variant_of_this_cpu_is_known_by_its_name() {
        let all = EmbreeVariant::all();
        assert!(all.len() >= 9, "SSE2 alone has 9");
        for variant in all {
            assert_eq!(variant.to_string().parse(), Ok(variant));
        }
    }

    #[test]
    fn parts_that_are_missing_are_the_default() {
        assert_eq!("default".parse(), Ok(EmbreeVariant::default()));
        assert_eq!("medium".parse(), Ok(EmbreeVariant::default()));
        let options = EmbreeOptions { quality: Quality::High, ..EmbreeOptions::default() };
        assert_eq!("high".parse(), Ok(EmbreeVariant(options)));
    }

    #[test]
    fn names_that_mean_nothing_say_what_would() {
        let refused = |name: &str, told: &str| {
            let said = name.parse::<EmbreeVariant>().unwrap_err().to_string();
            assert!(said.contains(told), "{name}: {said}");
        };
        refused("avx3-high", "'avx3' is no part");
        refused("", "'' is no part");
        refused("sse2-8", "sse2 has no packets of 8; sse2 goes up to 4");
        refused("high-coherent", "add 4, 8 or 16");
    }
}
