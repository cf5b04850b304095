//! What each word of the language says, in a line.

/// Every word. A new one is a new row.
const MEANINGS: &[(&str, &str)] = &[
    ("include", "`include \"file\"`: the statements of the file stand here"),
    ("class", "`class NAME is SOLID`: a solid with a name, to be used by later statements"),
    ("object", "`object [NAME] is SOLID`: a solid in the scene"),
    ("camera", "`camera [parallel] at (x, y, z)`: where the eye is"),
    (
        "parallel",
        "`camera parallel at (x, y, z)`: rays run side by side, so what is far is as large as what is near",
    ),
    ("target", "`target at (x, y, z)`: what the eye looks at; the origin if nothing is said"),
    ("focal", "`focal length F`: of a lens for 35 mm film; 50 if nothing is said"),
    ("light", "`light [point | beam | spot (c, a)] …`: a light; before a hue also the lightness"),
    ("ambient", "`ambient [intensity x] [COLOR]`: light from everywhere, without shadows"),
    ("background", "`background COLOR`: what is seen where nothing is"),
    ("fog", "`fog D`: what is D away is seen by half"),
    ("is", "stands between a name and its solid"),
    ("at", "`at (x, y, z)`: moves there, after scale and rotation"),
    ("length", "`focal length F`"),
    ("toward", "`toward (x, y, z)`: the point a beam or a spot is aimed at"),
    ("intensity", "`intensity x`: 1 if nothing is said"),
    ("point", "a light that shines in all directions"),
    ("radius", "`radius r`: of the sphere that a light comes from; shadows get soft edges"),
    (
        "aperture",
        "`camera at (x, y, z) aperture N focus at (x, y, z)`: a lens at f/N, which shows one plane sharp",
    ),
    (
        "focus",
        "`focus at (x, y, z)`: a point of the plane that is sharp; the target if nothing is said",
    ),
    ("beam", "a light whose rays are parallel"),
    (
        "spot",
        "`spot (c, a)`: falls off with the power c of the cosine, nothing beyond a degrees from its axis",
    ),
    ("no", "`no shadows`"),
    ("shadows", "`no shadows`: the light passes through everything"),
    ("scale", "`scale x` or `scale (x, y, z)`: the first of the transforms"),
    ("rotate", "`rotate (x, y, z)`: degrees about x, then y, then z"),
    ("shininess", "`shininess x`: the share of light that is reflected or let through, 0…1"),
    ("smoothness", "`smoothness m`: the slope of the facets, 0 is a mirror"),
    ("trans", "`trans (h, n)`: light halves every h units; index of refraction n, or `fake`"),
    ("fake", "`trans (h, fake)`: light goes straight through"),
    ("priority", "`priority n`: of two clear solids in one place the higher fills it"),
    (
        "paint",
        "`paint FUNCTION [(arguments)] [COLOR]`: blends toward the colour, or shows a picture",
    ),
    ("sphere", "radius 1 about the origin"),
    ("cylinder", "radius 1 about the x axis, from 0 to 1"),
    ("cone", "apex at the origin, radius 1 at x = 1"),
    ("block", "from -1 to 1 in x, y and z"),
    ("cube", "another word for `block`"),
    (
        "torus",
        "`torus (r)`: a ring of radius 1 about the x axis, r the radius of its tube; 0.25 if nothing is said",
    ),
    ("prism", "`prism ((x, y), (x, y), …)`: the polygon of these points, from z = 0 to 1"),
    (
        "terrain",
        "`terrain (seed, roughness, detail)`: a block with fractal ground from y = 0 to 1; 1, 0.5, 7",
    ),
    ("paraboloid", "apex at the origin, radius 1 at x = 1: a bowl that gathers beams along x"),
    ("dullest", "shininess 0, the default"),
    ("duller", "shininess 0.05"),
    ("dull", "shininess 0.2"),
    ("shiny", "shininess 0.5"),
    ("shinier", "shininess 0.8"),
    ("shiniest", "shininess 1"),
    ("roughest", "smoothness 0.6"),
    ("rougher", "smoothness 0.4"),
    ("rough", "smoothness 0.25, the default"),
    ("smooth", "smoothness 0.12"),
    ("smoother", "smoothness 0.05"),
    ("smoothest", "smoothness 0, a mirror"),
    ("pure", "highlights have the colour of the body, as on metal"),
    ("composite", "highlights have the colour of the light, as on plastic"),
    ("black", "a colour"),
    ("white", "a colour"),
    ("gray", "a colour; a lightness may stand before it"),
    ("grey", "another word for `gray`"),
    ("very", "`very dark`, `very light`"),
    ("dark", "a lightness"),
    ("medium", "the lightness if none is said"),
    ("grayish", "a quarter of full saturation"),
    ("greyish", "another word for `grayish`"),
    ("moderate", "half of full saturation"),
    ("strong", "three quarters of full saturation"),
    ("vivid", "full saturation, as if none is said"),
    ("hsv", "`hsv (h, s, v)`: degrees, 0…1, 0…1"),
    ("rgb", "`rgb (r, g, b)`: display values in 0…1"),
    ("let", "`let NAME = expression`: a number with a name"),
    ("repeat", "`repeat i from a to b [step c] { statements }`"),
    ("union", "`union of i from a to b [step c] ( solid )`: all of them"),
    ("intersection", "`intersection of i from a to b [step c] ( solid )`: what all of them share"),
    ("of", "`union of …`, `intersection of …`"),
    ("from", "the first number of a range"),
    ("to", "the last number of a range"),
    ("step", "the distance of the numbers of a range; 1 if nothing is said"),
    ("frame", "the number of the picture in a sequence, else 0"),
    ("pi", "3.14159…"),
    ("sin", "`sin(x)`, x in degrees"),
    ("cos", "`cos(x)`, x in degrees"),
    ("tan", "`tan(x)`, x in degrees"),
    ("sqrt", "`sqrt(x)`: the square root"),
    ("abs", "`abs(x)`: without its sign"),
    ("min", "`min(x, y, …)`: the least"),
    ("max", "`max(x, y, …)`: the greatest"),
    ("floor", "`floor(x)`: the next whole number below"),
    ("mod", "`mod(x, y)`: the remainder, with the sign of y"),
    ("brick", "bricks of the surface; the joints are not painted"),
    ("bump", "`bump (FUNCTION, height = 0.1)`: the surface looks raised by the function"),
    ("checker", "fields of the surface"),
    ("checker3d", "cubes in space"),
    ("decal", "`decal (\"file\", …)`: a picture at one place of the surface"),
    ("fourier", "a sum of waves"),
    ("gradient", "rises with height"),
    ("granite", "grains of many shades"),
    ("grid", "lines of the surface"),
    ("image", "`image (\"file\", …)`: a picture over the surface"),
    ("marble", "veins of noise"),
    ("noise", "clouds"),
    (
        "projection",
        "`projection (\"file\", at = V, toward = V, angle = 30)`: a picture thrown from a place",
    ),
    ("rings", "circles in the surface"),
    ("spots", "scattered balls"),
    ("stripes", "bands of the surface"),
    ("turbulence", "creased noise, as in flames"),
    ("surface", "u and v of a picture are those of the solid"),
    ("planar", "u and v of a picture run along x and y, from -1 to 1"),
    ("cylindrical", "u of a picture runs around the x axis, v along it from 0 to 1"),
    ("spherical", "u of a picture runs around the y axis, v from pole to pole"),
    ("box", "u and v of a picture are those of the side of a block that the surface looks to"),
    ("wood", "rings about an axis"),
    ("reddish", "a quarter of the way to red"),
    ("red", "a hue"),
    ("orangish", "a quarter of the way to orange"),
    ("orange", "a hue"),
    ("brownish", "a quarter of the way to brown"),
    ("brown", "a hue, a dark orange"),
    ("yellowish", "a quarter of the way to yellow"),
    ("yellow", "a hue"),
    ("greenish", "a quarter of the way to green"),
    ("green", "a hue"),
    ("bluish", "a quarter of the way to blue"),
    ("blue", "a hue"),
    ("purplish", "a quarter of the way to purple"),
    ("purple", "a hue"),
];

/// What a word says, in any case; empty if it is no word of the language.
pub(crate) fn of(word: &str) -> &'static str {
    let row = MEANINGS.iter().find(|(known, _)| word.eq_ignore_ascii_case(known));
    row.map_or("", |(_, meaning)| meaning)
}

#[cfg(test)]
mod tests {
    use compile::vocabulary::entries;

    use super::*;

    #[test]
    fn every_word_has_a_meaning_and_no_other() {
        for entry in entries() {
            assert!(!of(entry.word).is_empty(), "{}", entry.word);
        }
        for (word, _) in MEANINGS {
            assert!(entries().iter().any(|entry| entry.word == *word), "{word}");
        }
        assert_eq!(MEANINGS.len(), entries().len(), "each once");
    }
}
