// Generates a billion points of a single Poisson-disk set with the exact tile sampler in bounded
// memory, and verifies them at the same time. All arguments are optional and can be in any order:
//
//   billion [points=1e9] [seed=1] [tile=128] [order=rows|shuffled|hilbert] [threads=N]
//           [verify=yes|no] [gaps=64]
//
// The region is a square of whole cells around the origin with at least `points` points (1e3 to
// 5e9). It is generated in tiles of `tile` cells (16 to 512; a cell is r / sqrt(2) wide), in the
// given order, on 1 to 256 threads (default: all threads of the CPU). One in `gaps` tiles is
// checked for gaps (0: none). verify=no only generates and counts points. Progress is printed to
// standard error.
//
// Prints one line of JSON:
//   points_asked, seed, tile_cells, tile_radii, order, threads, verify, gaps
//       The request.
//   points, tiles, side_cells, side_radii
//       The result.
//   radius_squared, least_squared
//       The squared radius, and the smallest squared distance of any pair of points, both in squared
//       lattice units.
//   pairs, too_close
//       Pairs of points from cells at most two apart, which include all that can be too close, and
//       pairs that are closer than the radius.
//   misplaced, doubled
//       Points outside their own cell or tile, and points in a cell that already has one.
//   tiles_missing, tiles_repeated
//       Tiles of the region that were never finished, or finished more than once.
//   gap_tiles, uncovered, changed
//       Tiles checked for gaps, lattice points that no point covers, and tiles whose points differed
//       when they were sampled as part of a larger rectangle.
//   coverage, coverage_error, coverage_reference, coverage_z
//       The fraction of the plane that disks of diameter r cover, its standard error from blocks of
//       equal area, the reference, and the difference from the reference in standard errors.
//   coverage_lattice_loss
//       The reduction of the coverage by the lattice, measured on coarser lattices.
//   digest
//       Identifies the set of points, regardless of the order, tiles and threads.
//   seconds, points_per_second
//       Wall time of the whole run.
//   cpu_seconds, cpu_nanoseconds_per_point, sampling_seconds, checking_seconds, gap_seconds
//       CPU time.
//   checking_share
//       The time for checking relative to sampling, without the gap check, which is proportional to
//       1 / gaps.
//   rim_points
//       The maximum number of points kept at once for neighboring tiles.
//   resident_bytes, resident_limit
//       The peak memory of the process, and its limit.
//   compiler
//   broken
//       The guarantees that were violated.
// Unmeasured values are null. Exits with 0 if all guarantees hold, 1 if one is violated, 2 for
// invalid arguments.

#include "billion/run.hpp"
#include "common/timing.hpp"

#include "core/sampling/tile_sampler.hpp"

#include <charconv>
#include <cinttypes>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>
#include <thread>

namespace thicket::bench::billion {
namespace {

/// The maximum peak memory of the process: 64 MB.
constexpr std::uint64_t resident_limit = 64'000'000;

/// The maximum difference between the coverage and the reference, in standard errors.
constexpr double largest_z = 4.0;

constexpr const char *usage =
		"usage: billion [points=1e9] [seed=1] [tile=128] [order=rows|shuffled|hilbert] [threads=N] "
		"[verify=yes|no] [gaps=64]\n";

const char *name_of(TileOrder order) {
	switch (order) {
		case TileOrder::rows: return "rows";
		case TileOrder::shuffled: return "shuffled";
		case TileOrder::hilbert: return "hilbert";
	}
	return "";
}

/// Parses all of `text` as a number in [least, most]. Returns false for anything else.
template <typename Number>
bool read(std::string_view text, Number min_value, Number max_value, Number &r_number) {
	Number value{};
	const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
	if (error != std::errc{} || end != text.data() + text.size() || !(min_value <= value && value <= max_value)) {
		return false;
	}
	r_number = value;
	return true;
}

bool read_order(std::string_view text, TileOrder &r_order) {
	for (const TileOrder order : {TileOrder::rows, TileOrder::shuffled, TileOrder::hilbert}) {
		if (text == name_of(order)) {
			r_order = order;
			return true;
		}
	}
	return false;
}

/// Parses one argument. Returns an error message, or an empty string.
std::string read_argument(std::string_view argument, RunOptions &r_options) {
	const std::size_t equals = std::min(argument.find('='), argument.size());
	const std::string_view key = argument.substr(0, equals);
	const std::string_view value = argument.substr(std::min(equals + 1, argument.size()));
	const auto refuse = [&](bool fine, const char *must) {
		return fine ? std::string() : std::string(key) + " must be " + must + ", got \"" + std::string(value) + '"';
	};
	if (key == "points") {
		return refuse(read(value, 1e3, Region::max_points, r_options.points), "a number from 1e3 to 5e9");
	}
	if (key == "seed") {
		return refuse(read<std::uint64_t>(value, 0, ~std::uint64_t{0}, r_options.seed), "a whole number below 2^64");
	}
	if (key == "tile") {
		return refuse(read(value, 16, 512, r_options.tile), "a whole number of cells from 16 to 512");
	}
	if (key == "order") {
		return refuse(read_order(value, r_options.order), "rows, shuffled or hilbert");
	}
	if (key == "threads") {
		return refuse(read(value, 1u, 256u, r_options.threads), "a whole number from 1 to 256");
	}
	if (key == "verify") {
		r_options.verify = value == "yes";
		return refuse(value == "yes" || value == "no", "yes or no");
	}
	if (key == "gaps") {
		return refuse(read<std::uint64_t>(value, 0, 1'000'000'000, r_options.gaps), "a whole number from 0 to 1e9");
	}
	return "no such argument: " + std::string(argument);
}

/// Returns the peak memory of this process from /proc/self/status; 0 if the system has no such
/// file. Other sources include memory from before the process started this program.
std::uint64_t peak_resident_bytes() {
	std::ifstream status("/proc/self/status");
	for (std::string line; std::getline(status, line);) {
		std::uint64_t kibibytes = 0;
		if (std::sscanf(line.c_str(), "VmHWM: %" SCNu64 " kB", &kibibytes) == 1) {
			return kibibytes * 1024;
		}
	}
	return 0;
}

/// Writes a flat JSON object.
class JsonLine {
public:
	void text(const char *key, const std::string &value) { add(key, '"' + value + '"'); }
	void whole(const char *key, std::uint64_t value) { add(key, std::to_string(value)); }
	/// Writes null if the value is not finite.
	void real(const char *key, double value, int digits) {
		char number[64];
		std::snprintf(number, sizeof(number), "%.*g", digits, value);
		add(key, std::isfinite(value) ? number : "null");
	}
	void truth(const char *key, bool value) { add(key, value ? "true" : "false"); }
	/// Writes `value` verbatim, or null if `known` is false.
	void add(const char *key, const std::string &value, bool is_known = true) {
		line_ += line_.empty() ? "{\"" : ", \"";
		line_ += key;
		line_ += "\": ";
		line_ += is_known ? value : "null";
	}
	std::string end() const { return line_ + "}"; }

private:
	std::string line_;
};

double coverage_z(const Outcome &outcome) { return (outcome.coverage - jammed_coverage) / outcome.coverage_error; }

/// Returns the names of violated guarantees as a JSON array.
std::string broken_promises(const RunOptions &options, const Outcome &outcome, std::uint64_t resident) {
	const Findings &findings = outcome.found;
	const struct {
		const char *name;
		bool holds;
	} promises[] = {
			{"points", static_cast<double>(findings.points) >= options.points},
			{"tiles", outcome.tiles_finished == options.region().tiles() && outcome.tiles_repeated == 0},
			{"places", findings.misplaced == 0 && findings.doubled == 0},
			{"distance", findings.too_close == 0},
			{"gaps", outcome.gaps.uncovered == 0},
			{"windows", outcome.gaps.changed == 0},
			{"coverage", std::abs(coverage_z(outcome)) <= largest_z},
			{"memory", resident > 0 && resident < resident_limit},
	};
	std::string names;
	for (const auto &promise : promises) {
		if (!promise.holds) {
			names += (names.empty() ? "\"" : ", \"") + std::string(promise.name) + '"';
		}
	}
	return '[' + names + ']';
}

std::string hexadecimal(const Digest &digest) {
	char text[40];
	std::snprintf(text, sizeof(text), "\"%016" PRIx64 "%016" PRIx64 "\"", digest.high, digest.low);
	return text;
}

void describe_request(const RunOptions &options, JsonLine &r_line) {
	r_line.real("points_asked", options.points, 17);
	r_line.whole("seed", options.seed);
	r_line.whole("tile_cells", static_cast<std::uint64_t>(options.tile));
	r_line.real("tile_radii", options.tile / std::numbers::sqrt2, 6);
	r_line.text("order", name_of(options.order));
	r_line.whole("threads", options.threads);
	r_line.truth("verify", options.verify);
	r_line.whole("gaps", options.gaps);
}

void describe_findings(const RunOptions &options, const Outcome &outcome, JsonLine &r_line) {
	const Region region = options.region();
	const Findings &findings = outcome.found;
	const auto checked = [&](const char *key, std::uint64_t value) {
		r_line.add(key, std::to_string(value), options.verify);
	};
	r_line.whole("points", findings.points);
	r_line.whole("tiles", region.tiles());
	r_line.whole("side_cells", static_cast<std::uint64_t>(region.side));
	r_line.real("side_radii", region.side / std::numbers::sqrt2, 9);
	r_line.whole("radius_squared", radius_squared);
	r_line.add("least_squared", std::to_string(findings.min_squared_distance), options.verify && findings.pairs > 0);
	checked("pairs", findings.pairs);
	checked("too_close", findings.too_close);
	checked("misplaced", findings.misplaced);
	checked("doubled", findings.doubled);
	r_line.whole("tiles_missing", region.tiles() - outcome.tiles_finished);
	r_line.whole("tiles_repeated", outcome.tiles_repeated);
	checked("gap_tiles", outcome.gaps.tiles);
	checked("uncovered", outcome.gaps.uncovered);
	checked("changed", outcome.gaps.changed);
	r_line.real("coverage", outcome.coverage, 10);
	r_line.real("coverage_error", outcome.coverage_error, 4);
	r_line.real("coverage_reference", jammed_coverage, 10);
	r_line.real("coverage_z", coverage_z(outcome), 4);
	r_line.real("coverage_lattice_loss", coverage_lattice_loss, 3);
	r_line.whole("blocks", Region::blocks_per_side * Region::blocks_per_side);
	r_line.add("digest", hexadecimal(findings.digest), options.verify);
}

void describe_cost(const RunOptions &options, const Outcome &outcome, double cpu_seconds, std::uint64_t resident,
		JsonLine &r_line) {
	const auto points = static_cast<double>(outcome.found.points);
	r_line.real("seconds", outcome.seconds, 6);
	r_line.real("points_per_second", points / outcome.seconds, 6);
	r_line.real("cpu_seconds", cpu_seconds, 6);
	r_line.real("cpu_nanoseconds_per_point", 1e9 * cpu_seconds / points, 6);
	r_line.real("sampling_seconds", outcome.spent.sampling, 6);
	r_line.real("checking_seconds", outcome.spent.checking, 6);
	r_line.real("gap_seconds", outcome.spent.gaps, 6);
	r_line.real("checking_share", options.verify ? outcome.spent.checking / outcome.spent.sampling : NAN, 4);
	r_line.whole("rim_points", outcome.max_rim_points);
	r_line.add("resident_bytes", std::to_string(resident), resident > 0);
	r_line.whole("resident_limit", resident_limit);
	r_line.text("compiler", __VERSION__);
}

int run(const RunOptions &options) {
	Run run(options, [&options] {
		auto sampler = std::make_shared<TileSampler>();
		return [sampler, set = options.set()](const Rect &rect, std::vector<SamplePoint> &r_points) {
			return sampler->sample(set, rect, r_points);
		};
	});
	const auto start = std::chrono::steady_clock::now();
	const Outcome outcome = run.go([&](std::uint64_t points) {
		const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
		const auto generated = static_cast<double>(points);
		std::fprintf(stderr, "billion: %5.1f %%, %.0f million points, %.2f million per second\n",
				std::min(100.0, 100.0 * generated / options.points), 1e-6 * generated, 1e-6 * generated / seconds);
	});
	if (!outcome.status.ok()) {
		std::fprintf(stderr, "billion: %s\n", describe(outcome.status).c_str());
		return 1;
	}
	const std::uint64_t resident = peak_resident_bytes();
	const std::string broken = broken_promises(options, outcome, resident);
	JsonLine line;
	describe_request(options, line);
	describe_findings(options, outcome, line);
	describe_cost(options, outcome, cpu_seconds(), resident, line);
	line.add("broken", broken);
	std::printf("%s\n", line.end().c_str());
	return broken == "[]" ? 0 : 1;
}

} // namespace
} // namespace thicket::bench::billion

int main(int argument_count, char **arguments) {
	using namespace thicket::bench::billion;
	RunOptions options;
	options.threads = std::clamp(std::thread::hardware_concurrency(), 1u, 256u);
	for (int i = 1; i < argument_count; ++i) {
		if (const std::string error = read_argument(arguments[i], options); !error.empty()) {
			std::fprintf(stderr, "billion: %s\n%s", error.c_str(), usage);
			return 2;
		}
	}
	return run(options);
}
