//! How well a picture of known cost can be shared out, by simulation.
