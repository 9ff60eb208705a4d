//! Times one sampler of the crate faster_poisson, with which the benchmarks compare. Generates one set and prints a JSON
//! line.
//!
//!     faster_poisson NAME POINTS SEED [dump=FILE]
//!
//! NAME is faster_poisson_dart, faster_poisson_bridson or faster_poisson_parental. The radius is 1. The domain is a
//! bounded square whose area times the density of jammed disks is POINTS, as in tests/bench/domain_run.cpp. dump=FILE
//! writes the set as domain_run does: its count (u64) and its coordinates (f64 x, y), little-endian. The line has the
//! keys
//!
//!     method, points, seconds, size, maximal_claimed, toroidal, precision, version
//!
//! `seconds` is the CPU time of this process for creating the sampler and running it, after a run for a small set;
//! `size` is the edge length of the square.
//!
//! Behavior of the crate (version 1.3.0, read from its source, with the distances and gaps of each set measured): it
//! uses double precision, one thread and bounded domains. The radius is the minimum distance between points, and
//! distances are correct. No sampler claims or produces maximal sets. All cover less than 0.49 of the plane (a jammed
//! set covers 0.547), and leave positions that are 1.2 to 1.5 radii from every point. All run with the crate's defaults:
//! - dart: visits the cells of a grid of width r / sqrt(2) in random order, with six darts at each. This is not dart
//!   throwing, because each cell has only one turn, so positions that are hard to hit stay empty.
//! - bridson: Bridson (2007) with 16 candidates whose distance is biased toward the point.
//! - parental: the same with 14 candidates, none of them in the part of the ring that the point's own parent covers.
//!   This is the crate's default.

use faster_poisson::{Poisson2D, PoissonBridson2D, PoissonDart2D};
use std::f64::consts::PI;
use std::io::Write;
use std::process::ExitCode;

type Points = Vec<[f64; 2]>;

/// Points per unit of area at which randomly thrown disks of diameter 1 jam: coverage 0.547070.
const JAMMED_DENSITY: f64 = 0.547070 * 4.0 / PI;

const WARM_UP_POINTS: f64 = 1000.0;

fn side_for(points: f64) -> f64 {
	(points / JAMMED_DENSITY).sqrt()
}

fn sample(name: &str, points: f64, seed: u64) -> Option<Points> {
	let dims = [side_for(points); 2];
	match name {
		"faster_poisson_dart" => Some(PoissonDart2D::new().dims(dims).radius(1.0).seed(Some(seed)).run()),
		"faster_poisson_bridson" => Some(PoissonBridson2D::new().dims(dims).radius(1.0).seed(Some(seed)).run()),
		"faster_poisson_parental" => Some(Poisson2D::new().dims(dims).radius(1.0).seed(Some(seed)).run()),
		_ => None,
	}
}

/// Returns the CPU time of this process in seconds.
fn cpu_seconds() -> f64 {
	let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
	// SAFETY: the call writes only the structure that is passed to it.
	unsafe { libc::clock_gettime(libc::CLOCK_PROCESS_CPUTIME_ID, &mut time) };
	time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

fn dump(path: &str, points: &Points) -> std::io::Result<()> {
	let mut file = std::io::BufWriter::new(std::fs::File::create(path)?);
	file.write_all(&(points.len() as u64).to_le_bytes())?;
	for coordinate in points.iter().flatten() {
		file.write_all(&coordinate.to_le_bytes())?;
	}
	file.flush()
}

fn run(arguments: &[String]) -> Result<(), String> {
	let usage = "usage: faster_poisson faster_poisson_dart|faster_poisson_bridson|faster_poisson_parental \
	             POINTS SEED [dump=FILE]";
	let [name, points, seed, options @ ..] = arguments else {
		return Err(usage.into());
	};
	let points: f64 = points.parse().map_err(|_| usage)?;
	let seed: u64 = seed.parse().map_err(|_| usage)?;
	sample(name, WARM_UP_POINTS, seed).ok_or(usage)?;
	let start = cpu_seconds();
	let made = sample(name, points, seed).ok_or(usage)?;
	let seconds = cpu_seconds() - start;
	for option in options {
		let path = option.strip_prefix("dump=").ok_or(usage)?;
		dump(path, &made).map_err(|error| format!("{path}: {error}"))?;
	}
	println!(
		"{{\"method\": \"{name}\", \"points\": {}, \"seconds\": {seconds}, \"size\": {}, \"maximal_claimed\": false, \
		 \"toroidal\": false, \"precision\": \"double\", \"version\": \"1.3.0\"}}",
		made.len(),
		side_for(points)
	);
	Ok(())
}

fn main() -> ExitCode {
	let arguments: Vec<String> = std::env::args().skip(1).collect();
	match run(&arguments) {
		Ok(()) => ExitCode::SUCCESS,
		Err(message) => {
			eprintln!("{message}");
			ExitCode::from(2)
		}
	}
}
