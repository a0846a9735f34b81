//! The scattering model of a recipe or table: an item of [`BrdfKind`], the file of a tabulated BRDF, and the Fresnel
//! factor.

use std::{fmt, sync::Arc};

use glam::DVec3;
use serde::{Serialize, Serializer, ser::SerializeMap};

use super::{Brdf, BrdfKind, TabulatedBrdf, fresnel::LobeFresnel};
use crate::axes::PerAxis;

/// The scattering model to which a table is fitted. Two models are equal if their surfaces and their lobes are equal.
#[derive(Debug, Clone, PartialEq)]
pub struct BrdfModel {
    kind: BrdfKind,
    file: Option<TabulatedFile>,
    fresnel: LobeFresnel,
}

impl BrdfModel {
    /// The tabulated model of a file.
    #[must_use]
    pub fn tabulated(file: TabulatedFile) -> Self {
        Self { kind: BrdfKind::Tabulated, file: Some(file), fresnel: LobeFresnel::One }
    }

    /// The same model, fitted for other materials. Domain: a model that [has a Fresnel factor](BrdfKind::has_fresnel).
    #[must_use]
    pub fn with_fresnel(self, fresnel: LobeFresnel) -> Self {
        Self { fresnel, ..self }
    }

    /// The materials that a table is fitted for.
    #[must_use]
    pub fn fresnel(&self) -> &LobeFresnel {
        &self.fresnel
    }

    /// True if two models have the same surfaces. The materials of their lobes may differ.
    #[must_use]
    pub fn is_surface_of(&self, other: &Self) -> bool {
        (self.kind, &self.file) == (other.kind, &other.file)
    }

    /// The item of the list [`BrdfKind`].
    #[must_use]
    pub fn kind(&self) -> BrdfKind {
        self.kind
    }

    /// The file, if the model is tabulated.
    #[must_use]
    pub fn file(&self) -> Option<&TabulatedFile> {
        self.file.as_ref()
    }

    /// True if surfaces can be evaluated. A tabulated model needs the values of its file.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        !self.kind.needs_file() || self.data().is_some()
    }

    fn data(&self) -> Option<&Arc<TabulatedBrdf>> {
        self.file.as_ref().and_then(|file| file.data.as_ref())
    }

    /// The surface with these roughnesses along x and y. Domain: both in (0, 1].
    ///
    /// # Panics
    /// If [`BrdfModel::is_complete`] is false. Callers that read recipes and tables attach the file or return an error.
    #[must_use]
    pub fn surface(&self, roughness: [f64; 2]) -> Box<dyn Brdf> {
        if !self.kind.needs_file() {
            return self.kind.surface(roughness);
        }
        let data = self.data().expect("a tabulated model is evaluated with its file attached");
        Box::new(data.surface(roughness))
    }

    /// The surface whose lobe for `wo` is fitted. It has the Fresnel factor of [`BrdfModel::fresnel`]. Domain:
    /// roughness as for [`BrdfModel::surface`], `wo` of unit length above the horizon.
    ///
    /// # Panics
    /// The same as [`BrdfModel::surface`].
    #[must_use]
    pub fn lobe_surface(&self, roughness: [f64; 2], wo: DVec3) -> Box<dyn Brdf> {
        self.fresnel.applied(self.surface(roughness), wo)
    }

    /// The surface whose lobe is fitted at a point of a table. Its x axis is the axis of the larger roughness.
    ///
    /// # Panics
    /// The same as [`BrdfModel::surface`].
    #[must_use]
    pub fn lobe_surface_at(&self, place: &PerAxis<f64>) -> Box<dyn Brdf> {
        self.lobe_surface(place.roughness(), place.view())
    }

    /// The surface of the second lobe of an entry, at a point of a table; `None` if entries have one lobe.
    ///
    /// # Panics
    /// The same as [`BrdfModel::surface`].
    #[must_use]
    pub fn second_surface_at(&self, place: &PerAxis<f64>) -> Option<Box<dyn Brdf>> {
        self.fresnel.second_applied(self.surface_at(place))
    }

    /// The surface at a point of a table. Its x axis is the axis of the larger roughness.
    ///
    /// # Panics
    /// The same as [`BrdfModel::surface`].
    #[must_use]
    pub fn surface_at(&self, place: &PerAxis<f64>) -> Box<dyn Brdf> {
        self.surface(place.roughness())
    }

    /// Like [`BrdfKind::is_isotropic`]. A tabulated model is isotropic if its file is isotropic. If the values of the
    /// file were not read, the result is false.
    #[must_use]
    pub fn is_isotropic(&self) -> bool {
        match &self.file {
            Some(file) => file.data.as_ref().is_some_and(|data| data.axes().is_isotropic()),
            None => self.kind != BrdfKind::Tabulated && self.kind.is_isotropic(),
        }
    }

    /// True if even surfaces of ratio one change with the azimuth of the view. This holds if the file has azimuths of
    /// the view and its values were read.
    #[must_use]
    pub fn has_azimuths(&self) -> bool {
        self.data().is_some_and(|data| !data.axes().is_isotropic())
    }

    /// Like [`BrdfKind::follows_reflection`].
    #[must_use]
    pub fn follows_reflection(&self) -> bool {
        self.kind.follows_reflection()
    }
}

impl From<BrdfKind> for BrdfModel {
    /// A model without a file. [`BrdfKind::Tabulated`] is incomplete without a file: see [`BrdfModel::tabulated`].
    fn from(kind: BrdfKind) -> Self {
        Self { kind, file: None, fresnel: LobeFresnel::One }
    }
}

impl PartialEq<BrdfKind> for BrdfModel {
    fn eq(&self, kind: &BrdfKind) -> bool {
        self.kind == *kind
    }
}

impl fmt::Display for BrdfModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.kind.fmt(f)
    }
}

/// The fields of a canonical recipe: `brdf`, then `tabulated` for a tabulated BRDF, then `fresnel` if it is not the
/// default. The default is left out, so the digests of older recipes do not change.
impl Serialize for BrdfModel {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("brdf", &self.kind)?;
        if let Some(file) = &self.file {
            map.serialize_entry("tabulated", &file.to_string())?;
        }
        if !self.fresnel.is_one() {
            map.serialize_entry("fresnel", &self.fresnel)?;
        }
        map.end()
    }
}

/// The file of a tabulated BRDF, as a recipe names it. The values are missing if the file was not read.
#[derive(Clone)]
pub struct TabulatedFile {
    digest: [u8; 32],
    data: Option<Arc<TabulatedBrdf>>,
}

impl TabulatedFile {
    /// A file with this SHA-256 and its values.
    #[must_use]
    pub fn new(digest: [u8; 32], data: Arc<TabulatedBrdf>) -> Self {
        Self { digest, data: Some(data) }
    }

    /// A file with this SHA-256; its values were not read.
    #[must_use]
    pub fn unread(digest: [u8; 32]) -> Self {
        Self { digest, data: None }
    }

    /// SHA-256 of the file.
    #[must_use]
    pub fn digest(&self) -> &[u8; 32] {
        &self.digest
    }

    /// The values of the file, if it was read.
    #[must_use]
    pub fn data(&self) -> Option<&Arc<TabulatedBrdf>> {
        self.data.as_ref()
    }
}

/// Two files are equal if their digests are equal.
impl PartialEq for TabulatedFile {
    fn eq(&self, other: &Self) -> bool {
        self.digest == other.digest
    }
}

impl fmt::Display for TabulatedFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("sha256:")?;
        self.digest.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl fmt::Debug for TabulatedFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "TabulatedFile({self}, {})", if self.data.is_some() { "read" } else { "unread" })
    }
}
