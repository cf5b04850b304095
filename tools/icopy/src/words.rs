//! `--channels`: words for channels, and names of layers in `OpenEXR` files.

use std::error::Error;
use std::str::FromStr;

use idf::command::{ArgumentError, Channels};
use idf::plane::Role;
use idf::{Image, Kind};

use crate::{Pick, Source};

/// Channels with their new kinds, and layers by name.
#[derive(Clone, Debug)]
pub(crate) struct Words(Vec<Word>);

#[derive(Clone, Debug)]
enum Word {
    Pick(Pick),
    /// What only an `OpenEXR` file can have; as it is, or as these kinds.
    Layer {
        to: Vec<Kind>,
        name: String,
    },
}

impl Words {
    /// The first name that is no channel's.
    pub(crate) fn layer(&self) -> Option<&str> {
        self.layers().next().map(|(_, name)| name)
    }

    /// The layer that is to be the picture: one that gets other kinds, else the first.
    pub(crate) fn picture(&self) -> Result<Option<&str>, ArgumentError> {
        let mut given = self.layers().filter(|(to, _)| !to.is_empty()).map(|(_, name)| name);
        let Some(first) = given.next() else { return Ok(self.layer()) };
        match given.find(|other| *other != first) {
            None => Ok(Some(first)),
            Some(other) => {
                let message = format!(
                    "expected the channels of one layer, found `{first}` and `{other}`; copy each \
                     and put the channels together"
                );
                Err(ArgumentError::new(message))
            }
        }
    }

    /// Names of layers to keep as they are, beside the picture.
    pub(crate) fn kept(&self) -> Vec<String> {
        let picture = self.picture().ok().flatten();
        let bare = self.layers().filter(|(to, name)| to.is_empty() && Some(*name) != picture);
        bare.map(|(_, name)| name.to_owned()).collect()
    }

    /// Whether the picture's channels keep the names that they have.
    pub(crate) fn keep_names(&self) -> bool {
        self.layers().all(|(to, _)| to.is_empty())
    }

    /// The channels, where all words are such.
    pub(crate) fn picks(&self) -> Vec<Pick> {
        let pick = |word: &Word| match word {
            Word::Pick(pick) => Some(*pick),
            Word::Layer { .. } => None,
        };
        self.0.iter().filter_map(pick).collect()
    }

    /// The channels to take of `image`, which is the layer's picture.
    pub(crate) fn picks_of(
        &self,
        image: &Image,
    ) -> Result<Vec<Pick>, Box<dyn Error + Send + Sync>> {
        let picture = self.picture()?;
        let light = image.light_kinds()?;
        let covered = image.plane(Kind::Cvg).map(|_| Kind::Cvg);
        let mut picks = Vec::new();
        for word in &self.0 {
            match word {
                Word::Pick(pick) => picks.push(*pick),
                Word::Layer { to, name } if to.is_empty() => {
                    let all = light.iter().copied().chain(covered);
                    let all = all.filter(|_| Some(name.as_str()) == picture);
                    picks.extend(all.map(|kind| Pick { to: kind, from: kind.into() }));
                }
                Word::Layer { to, name } => {
                    if to.len() != light.len() && light.len() != 1 {
                        let found = light.len();
                        let message = format!(
                            "expected {} channels in layer `{name}`, found {found}",
                            to.len()
                        );
                        return Err(ArgumentError::new(message).into());
                    }
                    let from = light.iter().cycle();
                    let pairs = to.iter().zip(from);
                    picks.extend(pairs.map(|(&to, &from)| Pick { to, from: from.into() }));
                }
            }
        }
        Ok(picks)
    }

    fn layers(&self) -> impl Iterator<Item = (&[Kind], &str)> {
        self.0.iter().filter_map(|word| match word {
            Word::Pick(_) => None,
            Word::Layer { to, name } => Some((&to[..], name.as_str())),
        })
    }
}

impl FromStr for Words {
    type Err = ArgumentError;

    fn from_str(text: &str) -> Result<Self, ArgumentError> {
        let mut words = Vec::new();
        for word in text.split(',') {
            let (to, from) = word.split_once('=').unwrap_or((word, word));
            let to = match to.parse::<Channels>() {
                Ok(Channels(to)) => to,
                Err(error) if word.contains('=') || word.is_empty() => return Err(error),
                Err(_) => Vec::new(),
            };
            let source = match from.parse::<f64>() {
                Ok(number) if !to.is_empty() => Some(Source::Constant(number)),
                _ => (from == "luma").then_some(Source::Luminance),
            };
            if let Some(source) = source {
                for &kind in &to {
                    check_source(kind, source, word)?;
                    words.push(Word::Pick(Pick { to: kind, from: source }));
                }
                continue;
            }
            let Ok(Channels(from)) = from.parse::<Channels>() else {
                words.push(Word::Layer { to, name: from.into() });
                continue;
            };
            let tables = to.contains(&Kind::Lut) != from.contains(&Kind::Lut);
            if to.len() != from.len() && from.len() != 1 || tables {
                let message = format!("expected NEW=OLD of channels of one shape, found `{word}`");
                return Err(ArgumentError::new(message));
            }
            // rgb=grg: grey light as a colour.
            let from = from.iter().cycle();
            let picks = to.iter().zip(from).map(|(&to, &from)| Pick { to, from: from.into() });
            words.extend(picks.map(Word::Pick));
        }
        Ok(Self(words))
    }
}

/// Refuses a number that a channel cannot hold, and luminance that is no light.
fn check_source(kind: Kind, source: Source, word: &str) -> Result<(), ArgumentError> {
    let (fits, expected) = match (source, kind.role()) {
        (Source::Constant(number), Role::Light | Role::Coverage) => {
            ((0.0..=1.0).contains(&number), "a number from 0 to 1")
        }
        (Source::Constant(number), Role::Index) => {
            let whole = number.fract().abs() <= 0.0;
            (whole && (0.0..=255.0).contains(&number), "a whole number from 0 to 255")
        }
        (Source::Constant(number), Role::Data) => (number.is_finite(), "a number"),
        (Source::Luminance, Role::Light | Role::Coverage) => (true, ""),
        _ => (false, "a channel of the same shape"),
    };
    if fits {
        return Ok(());
    }
    Err(ArgumentError::new(format!("expected {expected} for {kind}, found `{word}`")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Words {
        text.parse().unwrap()
    }

    #[test]
    fn what_is_no_channel_is_a_layer() {
        assert_eq!(words("rgb,cvg=1,grg=luma").layer(), None);
        assert_eq!(words("rgb,cvg=1,grg=luma").picks().len(), 5);
        let layers = words("diffuse,dep,specular.R,diffuse");
        assert_eq!(layers.layer(), Some("diffuse"));
        assert_eq!(layers.picture().unwrap(), Some("diffuse"));
        assert_eq!(layers.kept(), ["specular.R"]);
        assert!(layers.keep_names());
        let renamed = words("specular,rgb=diffuse");
        assert_eq!(renamed.picture().unwrap(), Some("diffuse"));
        assert_eq!(renamed.kept(), ["specular"]);
        assert!(!renamed.keep_names());
        assert!(words("red=a,grn=b").picture().is_err());
        for wrong in ["diffuse=rgb", "", "rgb,,cvg", "lut=rgb"] {
            assert!(wrong.parse::<Words>().is_err(), "{wrong}");
        }
    }
}
