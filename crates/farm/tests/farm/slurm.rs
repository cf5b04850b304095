//! A cluster of four nodes on this machine, whose workers and nodes are killed.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use rustix::process::Signal;
use tempfile::TempDir;

use crate::process::{Worker, is_running, send};
use crate::{assert_same_image, farm, folder, parts, says, whole};

/// A cluster that ends with this value.
struct Cluster {
    folder: TempDir,
}

impl Cluster {
    /// None where Slurm is not installed, or cannot be started.
    fn start(nodes: u32) -> Option<Self> {
        let folder = TempDir::new().unwrap();
        let output = Command::new("bash")
            .arg(script())
            .args(["start", folder.path().to_str().unwrap(), &nodes.to_string()])
            .stdin(Stdio::null())
            .output()
            .unwrap();
        match output.status.code() {
            Some(0) => Some(Self { folder }),
            // What the script says where it cannot be done.
            Some(77) => {
                let why = String::from_utf8_lossy(&output.stderr).into_owned();
                // Not caught by the harness, which shows nothing of tests that pass.
                let line = format!("skipped, no cluster of Slurm: {}\n", why.trim());
                std::io::stderr().write_all(line.as_bytes()).unwrap();
                None
            }
            _ => panic!("{}", String::from_utf8_lossy(&output.stderr)),
        }
    }

    fn settings(&self) -> PathBuf {
        self.folder.path().join("slurm.conf")
    }

    /// The number of the process that stands for a node.
    fn node(&self, name: &str) -> u32 {
        let path = self.folder.path().join(format!("run/slurmd.{name}.pid"));
        fs::read_to_string(path).unwrap().trim().parse().unwrap()
    }
}

impl Drop for Cluster {
    fn drop(&mut self) {
        Command::new("bash").arg(script()).arg("stop").arg(self.folder.path()).status().ok();
    }
}

fn script() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/farm/cluster.sh")
}

#[test]
fn a_killed_worker_and_a_killed_node_leave_no_trace_in_the_picture() {
    let Some(cluster) = Cluster::start(4) else { return };
    let folder = folder();
    let words = "--size 200x150 --samples 16";
    whole(folder.path(), &format!("-o OUT/whole {words}"));
    let output = folder.path().join("x");
    let work = output.with_extension("farm");
    let child = farm(
        folder.path(),
        &format!("--engine slurm --parts 12 -v -o {} {words}", output.display()),
    )
    .env("SLURM_CONF", cluster.settings())
    .spawn()
    .unwrap();
    let running = || {
        assert!(is_running(child.id()), "ended before all was killed");
        Worker::all(&work)
    };
    while parts(&work) == 0 {
        running();
    }
    // One worker.
    let killed = loop {
        let workers = running();
        if let Some(worker) = workers.first().filter(|worker| send(worker.pid, Signal::KILL)) {
            break *worker;
        }
    };
    // One node, with all that runs there: the node's own process, that of the job, and the worker.
    loop {
        let workers = running();
        let other = workers.into_iter().find(|worker| *worker != killed);
        let Some(worker) = other else { continue };
        let Some(node) = worker.variable("SLURMD_NODENAME") else { continue };
        let Some(step) = worker.parent().filter(|&pid| pid > 1) else { continue };
        send(cluster.node(&node), Signal::KILL);
        send(step, Signal::KILL);
        send(worker.pid, Signal::KILL);
        break;
    }
    let output = child.wait_with_output().unwrap();
    let text = says(&output);
    assert_eq!(output.status.code(), Some(0), "{text}");
    assert!(text.contains("is rendered again, as its worker was killed"), "{text}");
    assert_same_image(folder.path(), "whole", "x");
    assert!(!work.exists(), "nothing is left over");
}

#[test]
fn a_killed_driver_finds_its_jobs_again() {
    let Some(cluster) = Cluster::start(2) else { return };
    let folder = folder();
    let words = "--size 160x120 --samples 16";
    whole(folder.path(), &format!("-o OUT/whole.png {words}"));
    let output = folder.path().join("x.png");
    let work = output.with_extension("farm");
    let command = || {
        let words = format!("--engine slurm --parts 6 -o {} {words}", output.display());
        let mut command = farm(folder.path(), &words);
        command.env("SLURM_CONF", cluster.settings());
        command
    };
    let mut child = command().spawn().unwrap();
    while parts(&work) == 0 {
        assert!(is_running(child.id()), "ended before it was killed");
    }
    send(child.id(), Signal::KILL);
    child.wait().unwrap();
    let submitted = fs::read_to_string(work.join("submitted")).unwrap();
    let second = command().output().unwrap();
    assert_eq!(second.status.code(), Some(0), "{}", says(&second));
    assert_eq!(submitted.lines().count(), 1, "one array: {submitted}");
    assert!(!says(&second).contains("rendered again"), "{}", says(&second));
    let bytes = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert!(bytes("whole.png") == bytes("x.png"));
    // Told to end, the driver takes its jobs out of the queue.
    fs::remove_file(&output).unwrap();
    let mut child = command().spawn().unwrap();
    while Worker::all(&work).is_empty() {
        assert!(is_running(child.id()), "ended before it was told to");
    }
    send(child.id(), Signal::TERM);
    assert_eq!(child.wait().unwrap().code(), Some(1));
    while !Worker::all(&work).is_empty() {}
    let squeue = Command::new("squeue")
        .args(["--noheader", "--states=PENDING,RUNNING"])
        .env("SLURM_CONF", cluster.settings())
        .output()
        .unwrap();
    assert_eq!(String::from_utf8_lossy(&squeue.stdout), "", "no jobs are left");
}
