//! The light that leaves a point toward the eye, one physical effect a file.

pub(crate) mod clear;
pub(crate) mod facet;
pub(crate) mod fog;
pub(crate) mod footprint;
pub(crate) mod fresnel;
pub(crate) mod light;
pub(crate) mod microfacet;
pub(crate) mod opaque;
pub(crate) mod paint;
pub(crate) mod pyramid;
pub(crate) mod relief;
pub(crate) mod spark;
pub(crate) mod texture_file;
pub(crate) mod transmission;
