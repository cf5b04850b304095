//! Ways of sampling, and what they promise.

use std::fs;

use idf::exchange::read_image;
use idf::{Image, Kind, ReadOptions, Samples};

use super::{folder, picture, portray, says};

#[test]
fn ways_of_sampling_are_told_apart() {
    let ways = [
        "--aa none --samples 16",
        "--aa adaptive",
        "--aa adaptive --samples 64",
        "--aa stochastic",
        "--aa stochastic --samples 5",
        "--aa stochastic --seed 1",
        "--filter tent --samples 1",
        "--filter mitchell --samples 4",
        "--filter tent --aa adaptive",
        "--filter mitchell --aa stochastic",
        "--certify",
        "--certify --samples 16",
        "--certify --aa stochastic",
    ];
    let pictures = ways.map(picture);
    for (number, (way, found)) in ways.iter().zip(&pictures).enumerate() {
        for (other, before) in ways.iter().zip(&pictures).take(number) {
            assert!(found.planes() != before.planes(), "{way} is not {other}");
        }
        for threads in [1, 3] {
            let again = picture(&format!("{way} --threads {threads}"));
            assert!(again.planes() == found.planes(), "{way} on {threads} threads");
        }
    }
    for (way, same) in
        [("--aa stochastic --samples 16 --seed 0", 3), ("--aa adaptive --samples 16", 1), ("", 1)]
            .into_iter()
            .chain([("--samples 16", 0), ("--filter tent", 8)])
    {
        assert!(picture(way).planes() == pictures[same].planes(), "{way} is the default");
    }
    // All of them show the same, each with its own error.
    let light = |image: &Image| -> Vec<f64> {
        let plane = image.plane(Kind::Red);
        let Some(Samples::U8(bytes)) = plane else { panic!("{plane:?}") };
        bytes.iter().map(|&byte| f64::from(byte)).collect()
    };
    let truth = light(&picture("--samples 256"));
    for (way, found) in ways.iter().zip(&pictures) {
        // Wider filters show what is beside a pixel, too.
        let most = if way.contains("filter") { 30.0 } else { 15.0 };
        let pairs = truth.iter().zip(light(found));
        let square: f64 = pairs.map(|(a, b)| (a - b) * (a - b)).sum();
        let off = (square / truth.len() as f64).sqrt();
        assert!(off < most, "{way}: {off}");
        assert!(way.contains("filter") || off > 0.0, "{way}: {off}");
    }
}

#[test]
fn scenes_of_light_that_is_drawn_by_lot_choose_their_samples() {
    let folder = folder();
    let camera = "camera at (0, 1, 9)";
    let scene = |light: &str, camera: &str| {
        format!("object is shiny red smoothness 0.2 sphere light at (5, 9, 5) {light}\n{camera}\n")
    };
    let run = |scene: &str, options: &str| {
        let line = format!("- -o x.ppm --size 16x16 {options}");
        let output = portray(folder.path(), &line, scene);
        assert_eq!(output.status.code(), Some(0), "{options}: {}", says(&output));
        (fs::read(folder.path().join("x.ppm")).unwrap(), says(&output))
    };
    let lens = format!("{camera} aperture 2 focus at (0, 0, 0)");
    for (scene, option, way, why) in [
        (scene("", camera), "", "adaptive", "nothing is drawn by lot"),
        (scene("radius 2", camera), "", "stochastic", "soft lights"),
        (scene("", &lens), "", "stochastic", "a lens"),
        (scene("", camera), "--glossy", "stochastic", "glossy surfaces"),
    ] {
        let (chosen, said) = run(&scene, &format!("{option} -v"));
        let line = format!("--aa {way}, for {why}\n");
        assert!(said.contains(&line), "expected {line}, found {said}");
        let asked = |way: &str| run(&scene, &format!("{option} --aa {way}"));
        assert!(chosen == asked(way).0, "{scene}{option}: {way}");
        let other = if way == "adaptive" { "stochastic" } else { "adaptive" };
        assert!(chosen != asked(other).0, "{scene}{option}: not {other}");
        let (said, grid) =
            (run(&scene, &format!("{option} --samples 4 -v")), "--aa none --samples 4");
        assert!(!said.1.contains("--aa"), "what was asked for is not chosen: {}", said.1);
        assert!(said.0 == run(&scene, &format!("{option} {grid}")).0, "{scene}{option}");
    }
}

/// The number of a line of `--stats`.
fn figure(stats: &str, name: &str) -> Option<f64> {
    let line = stats.lines().find_map(|line| line.trim().strip_prefix(&format!("\"{name}\": ")))?;
    Some(line.trim_end_matches(',').parse().unwrap())
}

#[test]
fn pictures_are_as_good_as_they_were_asked_for() {
    let folder = folder();
    let run = |options: &str| {
        let line = format!("good.sdl --size 48x40 -o out --stats s.json {options}");
        let output = portray(folder.path(), &line, "");
        assert_eq!(output.status.code(), Some(0), "{options}: {output:?}");
        let image = read_image(&folder.path().join("out"), &ReadOptions::default()).unwrap();
        (image, fs::read_to_string(folder.path().join("s.json")).unwrap(), says(&output))
    };
    let mut before = f64::INFINITY;
    for wanted in [20.0, 4.0, 1.0, 0.6] {
        for filter in ["box", "tent"] {
            let options = format!("--error {wanted} --filter {filter}");
            let (image, stats, said) = run(&format!("{options} --audit"));
            let error = figure(&stats, "estimated_error").unwrap();
            assert!(error <= wanted, "{options}: {error}");
            // Rounding adds the variance of a step.
            let rounded = (error * error + 1.0 / 12.0).sqrt();
            let in_8_bits = figure(&stats, "estimated_error_in_8_bits").unwrap();
            assert!((in_8_bits - rounded).abs() < 1e-3, "{options}: {in_8_bits}");
            let (audited, deviation) = (
                figure(&stats, "audited_error").unwrap(),
                figure(&stats, "audited_error_deviation").unwrap(),
            );
            assert!(
                (audited - error).abs() < 0.25 * error + 5.0 * deviation,
                "{options}: {audited} ± {deviation}, not {error}"
            );
            assert!(said.starts_with("off by ") && said.contains(" 1920 pixels"), "{said}");
            for threads in ["1", "3"] {
                let again = run(&format!("{options} --threads {threads}")).0;
                assert!(again.planes() == image.planes(), "{options} on {threads} threads");
            }
            if filter == "box" {
                assert!(error <= before, "{options}: {error}");
                before = error;
            }
        }
    }
    let (_, stats, said) = run("--seconds 0.000001");
    assert_eq!(figure(&stats, "samples"), Some(1.0), "one sample: {stats}");
    assert!(said.contains("warning: there was time for one sample"), "{said}");
    assert_eq!(figure(&stats, "estimated_error"), None, "nothing is known");
    let (_, stats, said) = run("--seconds 0.6");
    assert!(figure(&stats, "samples").unwrap() > 2.0 && said.is_empty(), "{stats} {said}");
    let seconds = figure(&stats, "trace_seconds").unwrap();
    assert!(seconds < 60.0 && figure(&stats, "estimated_error").is_some(), "{stats}");
    let (_, stats, said) = run("--aa adaptive --audit -q");
    assert!(said.is_empty() && figure(&stats, "audited_error").unwrap() > 0.0, "{stats}");
    assert_eq!(figure(&stats, "estimated_error"), None, "corners know nothing of their error");
}

/// The mean of the red channel of a ball that is `look`, all in the same light, around the middle of the picture.
fn seen_of_a_ball(look: &str, options: &str) -> f64 {
    let folder = folder();
    // Neither ambient light nor lamps: what is seen is mirrored.
    let scene = format!(
        "object is {look} sphere camera at (0, 0, 9) background rgb (1, 1, 1) ambient intensity 0"
    );
    let line = format!("- -o ball.exr --size 16x16 --channels rgb,cvg {options}");
    let output = portray(folder.path(), &line, &scene);
    assert_eq!((output.status.code(), says(&output)), (Some(0), String::new()), "{options}");
    let image = read_image(&folder.path().join("ball.exr"), &ReadOptions::default()).unwrap();
    let Some(Samples::F32(light)) = image.plane(Kind::Red) else { panic!("{:?}", image.kinds()) };
    let middle = (6..10).flat_map(|row| (6..10).map(move |column| light[16 * row + column]));
    middle.map(f64::from).sum::<f64>() / 16.0
}

#[test]
fn rough_surfaces_mirror_what_is_around_them_if_that_is_wanted() {
    let lots = "--aa stochastic --samples 256";
    for look in ["shininess 1 pure smoothness 0.05 white", "shininess 1 pure smoothness 0.3 white"]
    {
        let without = seen_of_a_ball(look, lots);
        assert!(without.abs() < 1e-9, "{look}: {without}");
        // All that comes from around goes to the eye, but for what stays in the grooves.
        let with = seen_of_a_ball(look, &format!("{lots} --glossy"));
        assert!(with > 0.97 && with <= 1.0, "{look}: {with}");
    }
    // The rest is the body's.
    let share = seen_of_a_ball("shininess 0.25 smoothness 0.2 black", &format!("{lots} --glossy"));
    assert!((share - 0.25).abs() < 0.02, "{share}");
    // A clear body loses nothing: what it does not reflect goes through.
    let clear = "trans (1e9, 1.5) shininess 1 smoothness 0.3";
    let [rough, smooth] = [clear, "trans (1e9, 1.5) shininess 1 smoothness 0"]
        .map(|look| seen_of_a_ball(look, &format!("{lots} --glossy --min-weight 0")));
    assert!((rough / smooth - 1.0).abs() < 0.01, "{rough} and {smooth}");
    // One sample in the middle shows a mirror.
    let [rough, smooth] = ["smoothness 0.3", "smoothness 0"]
        .map(|look| format!("shininess 1 pure white {look}"))
        .map(|look| seen_of_a_ball(&look, "--glossy --samples 1"));
    assert!((rough - smooth).abs() < 1e-6, "{rough} and {smooth}");
    let [one, three] = [1, 3].map(|threads| {
        let options = format!("--glossy --aa stochastic --samples 5 --threads {threads}");
        seen_of_a_ball("shininess 1 pure smoothness 0.3 white", &options)
    });
    assert!((one - three).abs() <= 0.0, "on any number of threads");
}

#[test]
fn what_is_certain_is_said_and_what_cannot_be_is_refused() {
    let folder = folder();
    let line = "good.sdl --size 64x48 -o out --stats s.json --certify";
    let output = portray(folder.path(), line, "");
    assert_eq!((output.status.code(), says(&output)), (Some(0), String::new()), "{line}");
    let stats = fs::read_to_string(folder.path().join("s.json")).unwrap();
    let of = |name| figure(&stats, name).unwrap();
    let (certain, undecided) = (of("certain_share"), of("undecided_share"));
    assert!(certain > 0.7 && (certain + undecided - 1.0).abs() < 2e-5, "{stats}");
    assert!(of("undecided_bound") > 0.0 && of("undecided_bound") < 150.0, "{stats}");
    assert!(of("tiles_given_up_share") <= 0.5 && of("certify_seconds") > 0.0, "{stats}");
    for (options, message) in [
        ("--filter tent", "--certify with --filter: proofs are of the square of a pixel"),
        ("--aa adaptive", "--certify with --aa adaptive: "),
        ("--error 1", "--certify with --error: "),
        ("--seconds 1", "--certify with --seconds: "),
    ] {
        let output = portray(folder.path(), &format!("good.sdl -o x.png --certify {options}"), "");
        assert_eq!(output.status.code(), Some(2), "{options}: {}", says(&output));
        assert!(says(&output).contains(message), "{options}: {}", says(&output));
    }
    let lens = "object is sphere camera at (0, 0, 9) aperture 2 focus at (0, 0, 0)";
    let output = portray(folder.path(), "- -o x.png --certify", lens);
    assert_eq!(output.status.code(), Some(1), "{}", says(&output));
    assert!(says(&output).contains("nothing can be certified: rays through a lens"), "{output:?}");
}
