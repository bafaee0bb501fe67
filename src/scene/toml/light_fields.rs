//! The fields of a light, whatever its kind.

use serde::Deserialize;

use super::LightEntry;

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Kind {
    Point,
    Spot,
    Directional,
}

/// All that the table of a light may hold.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LightFields {
    kind: Kind,
    position: Option<[f64; 3]>,
    target: Option<[f64; 3]>,
    from: Option<[f64; 3]>,
    intensity: Option<[f32; 3]>,
    irradiance: Option<[f32; 3]>,
    inner: Option<f64>,
    outer: Option<f64>,
}

impl LightFields {
    /// Refuses a field that this kind of light does not have.
    fn check(&self) -> Result<(), String> {
        let (is_spot, is_directional) =
            (matches!(self.kind, Kind::Spot), matches!(self.kind, Kind::Directional));
        let strange = [
            ("position", self.position.is_some() && is_directional),
            ("target", self.target.is_some() && !is_spot),
            ("from", self.from.is_some() && !is_directional),
            ("intensity", self.intensity.is_some() && is_directional),
            ("irradiance", self.irradiance.is_some() && !is_directional),
            ("inner", self.inner.is_some() && !is_spot),
            ("outer", self.outer.is_some() && !is_spot),
        ];
        match strange.iter().find(|(_, is_strange)| *is_strange) {
            None => Ok(()),
            Some((name, _)) => {
                let kind = format!("{:?}", self.kind).to_lowercase();
                Err(format!("a {kind} light has no field `{name}`; leave it out"))
            }
        }
    }
}

impl TryFrom<LightFields> for LightEntry {
    type Error = String;

    fn try_from(fields: LightFields) -> Result<Self, String> {
        fn given<T>(field: Option<T>, name: &str) -> Result<T, String> {
            field.ok_or_else(|| format!("missing field `{name}`"))
        }
        fields.check()?;
        let LightFields { kind, position, target, from, intensity, irradiance, inner, outer } =
            fields;
        Ok(match kind {
            Kind::Point => Self::Point {
                position: given(position, "position")?,
                intensity: given(intensity, "intensity")?,
            },
            Kind::Spot => Self::Spot {
                position: given(position, "position")?,
                target: given(target, "target")?,
                intensity: given(intensity, "intensity")?,
                inner: inner.unwrap_or(0.0),
                outer: given(outer, "outer")?,
            },
            Kind::Directional => Self::Directional {
                from: given(from, "from")?,
                irradiance: given(irradiance, "irradiance")?,
            },
        })
    }
}
