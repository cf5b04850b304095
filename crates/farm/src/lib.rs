//! Pictures and sequences over many processes: on this machine, or on the nodes of a Slurm cluster.
//!
//! A picture is cut into parts ([`idf::part`]), and a unit of work is one part of one picture of a sequence. A worker is a
//! process that renders one unit and puts the part, under its name, into the work folder. **The finished part on disk is the
//! truth**: whether a unit is done is asked of the part there, with its checksum, and of nothing else. What a queue or
//! the end of a process says is only the occasion to look. So workers, nodes, the queue and the driver itself may be killed
//! at any time: the driver, or the next one that is started with the same command, sees what is missing and has it done.
//!
//! ```text
//! prfarm render ─ compiles ─→ x.farm/scene.prc            the work folder   folder.rs
//!      │                      x.farm/job.json             the command line, read by workers
//!      ├─ engine: local or slurm ─→ prfarm part … ─→ x.farm/scene-003.idf   worker.rs
//!      └─ all parts of a picture are there ─→ x.png, x.frames               merge.rs
//! ```

pub mod command;
mod driver;
mod engine;
mod folder;
mod merge;
mod picture;
mod report;
pub mod schedule;
mod worker;
