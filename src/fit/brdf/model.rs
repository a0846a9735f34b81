//! The scattering model of a recipe or table: an item of the list, and the file that one of them needs.

use std::{fmt, sync::Arc};

use glam::DVec3;
use serde::{Serialize, Serializer, ser::SerializeMap};

use super::{Brdf, BrdfKind, TabulatedBrdf, fresnel::LobeFresnel};
use crate::axes::PerAxis;

/// The scattering model that is fitted. Two are equal if their surfaces and the lobes of these are.
#[derive(Debug, Clone, PartialEq)]
pub struct BrdfModel {
    kind: BrdfKind,
    file: Option<TabulatedFile>,
    fresnel: LobeFresnel,
}

impl BrdfModel {
    /// The model of a file.
    #[must_use]
    pub fn tabulated(file: TabulatedFile) -> Self {
        Self { kind: BrdfKind::Tabulated, file: Some(file), fresnel: LobeFresnel::One }
    }

    /// The same model with lobes of other materials. Domain: one that [has a Fresnel factor](BrdfKind::has_fresnel).
    #[must_use]
    pub fn with_fresnel(self, fresnel: LobeFresnel) -> Self {
        Self { fresnel, ..self }
    }

    /// The materials whose lobe a table is fitted to.
    #[must_use]
    pub fn fresnel(&self) -> &LobeFresnel {
        &self.fresnel
    }

    /// Whether two models have the same surfaces, whatever the materials whose lobes are fitted.
    #[must_use]
    pub fn is_surface_of(&self, other: &Self) -> bool {
        (self.kind, &self.file) == (other.kind, &other.file)
    }

    /// Its item in the list.
    #[must_use]
    pub fn kind(&self) -> BrdfKind {
        self.kind
    }

    /// The file, if the model is tabulated.
    #[must_use]
    pub fn file(&self) -> Option<&TabulatedFile> {
        self.file.as_ref()
    }

    /// Whether its surfaces can be had: a tabulated model has its file's numbers.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        !self.kind.needs_file() || self.data().is_some()
    }

    fn data(&self) -> Option<&Arc<TabulatedBrdf>> {
        self.file.as_ref().and_then(|file| file.data.as_ref())
    }

    /// The surface of these roughnesses along x and y. Domain: both in (0, 1].
    ///
    /// # Panics
    /// Where [`BrdfModel::is_complete`] does not hold. What reads recipes and tables attaches files, or refuses to go
    /// on.
    #[must_use]
    pub fn surface(&self, roughness: [f64; 2]) -> Box<dyn Brdf> {
        if !self.kind.needs_file() {
            return self.kind.surface(roughness);
        }
        let data = self.data().expect("a tabulated model is evaluated with its file attached");
        Box::new(data.surface(roughness))
    }

    /// The surface whose lobe for `wo` is fitted: with the Fresnel factor of [`BrdfModel::fresnel`]. Domain: as
    /// [`BrdfModel::surface`], and `wo` of unit length above the horizon.
    ///
    /// # Panics
    /// As [`BrdfModel::surface`].
    #[must_use]
    pub fn lobe_surface(&self, roughness: [f64; 2], wo: DVec3) -> Box<dyn Brdf> {
        self.fresnel.applied(self.surface(roughness), wo)
    }

    /// The same at a place of a table, x along its larger roughness.
    ///
    /// # Panics
    /// As [`BrdfModel::surface`].
    #[must_use]
    pub fn lobe_surface_at(&self, place: &PerAxis<f64>) -> Box<dyn Brdf> {
        self.lobe_surface(place.roughness(), place.view())
    }

    /// The surface whose lobe is the second of an entry, at a place of a table; `None` where entries have one lobe.
    ///
    /// # Panics
    /// As [`BrdfModel::surface`].
    #[must_use]
    pub fn second_surface_at(&self, place: &PerAxis<f64>) -> Option<Box<dyn Brdf>> {
        self.fresnel.second_applied(self.surface_at(place))
    }

    /// The surface at a place of a table, x along its larger roughness.
    ///
    /// # Panics
    /// As [`BrdfModel::surface`].
    #[must_use]
    pub fn surface_at(&self, place: &PerAxis<f64>) -> Box<dyn Brdf> {
        self.surface(place.roughness())
    }

    /// As [`BrdfKind::is_isotropic`]; a file tells itself, and one that was not read may be of either.
    #[must_use]
    pub fn is_isotropic(&self) -> bool {
        match &self.file {
            Some(file) => file.data.as_ref().is_some_and(|data| data.axes().is_isotropic()),
            None => self.kind != BrdfKind::Tabulated && self.kind.is_isotropic(),
        }
    }

    /// Whether its surfaces differ in azimuths whatever their ratio of roughnesses: those of a file with azimuths of the view,
    /// where that was read.
    #[must_use]
    pub fn has_azimuths(&self) -> bool {
        self.data().is_some_and(|data| !data.axes().is_isotropic())
    }

    /// As [`BrdfKind::follows_reflection`].
    #[must_use]
    pub fn follows_reflection(&self) -> bool {
        self.kind.follows_reflection()
    }
}

impl From<BrdfKind> for BrdfModel {
    /// The model of formulas. [`BrdfKind::Tabulated`] is not complete without a file: see [`BrdfModel::tabulated`].
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

/// The fields of a canonical recipe: `brdf`, for a tabulated one `tabulated`, and `fresnel` where it is not the default, so
/// that recipes keep their digests.
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

/// The file of a tabulated BRDF as a recipe names it, with its numbers where they are at hand.
#[derive(Clone)]
pub struct TabulatedFile {
    digest: [u8; 32],
    data: Option<Arc<TabulatedBrdf>>,
}

impl TabulatedFile {
    /// The file with this SHA-256, and its contents.
    #[must_use]
    pub fn new(digest: [u8; 32], data: Arc<TabulatedBrdf>) -> Self {
        Self { digest, data: Some(data) }
    }

    /// The file with this SHA-256, which was not read.
    #[must_use]
    pub fn unread(digest: [u8; 32]) -> Self {
        Self { digest, data: None }
    }

    /// SHA-256 of the file.
    #[must_use]
    pub fn digest(&self) -> &[u8; 32] {
        &self.digest
    }

    /// The contents of the file, if it was read.
    #[must_use]
    pub fn data(&self) -> Option<&Arc<TabulatedBrdf>> {
        self.data.as_ref()
    }
}

/// Equal files have equal digests.
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
