// Times one method on one domain, for tests/bench/figures.sh. Prints one JSON object per line for
// each set.
//   domain_run METHOD PRECISION POINTS SEED [cell=RADII] [darts=DARTS] [sets=COUNT] [torus] [fill]
//              [dump=FILE]
// METHOD: naive, hierarchical, accumulator, wavefront (single and double); tile, reference,
// scalloped, boundary, jones (double); plain_bridson, bridson (single). The radius is 1. The domain
// is a square in which a jammed set has POINTS points. `reference` is naive dart throwing until no
// dart fits.
//   cell=RADII   the width of an accelerator cell; 0 for the method's default
//   darts=DARTS  the number of darts that `naive` throws per base square
//   sets=COUNT   the number of sets, with consecutive seeds from SEED
//   torus        makes opposite edges meet, for the first four methods; reference, scalloped,
//                boundary and jones always use a torus
//   fill         leaves the points in the accelerator cells without copying them, for the first
//                four methods
//   dump=FILE    writes the sets, each as its count (uint64) and its coordinates (float64 x, y),
//                little-endian
// `seconds` is the CPU time of the call that generates the points, from a new object to a filled
// vector.

#include "tests/analysis/naive_darts.hpp"
#include "tests/bench/baselines/boundary_sampling.hpp"
#include "tests/bench/baselines/scalloped_sectors.hpp"
#include "tests/bench/baselines/voronoi_darts.hpp"
#include "tests/bench/common/bridson.hpp"
#include "tests/bench/common/plain_bridson.hpp"
#include "tests/bench/common/timing.hpp"

#include "core/sampling/domain/domain_sampler.hpp"
#include "core/sampling/tile_sampler.hpp"

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

namespace thicket::bench {
namespace {

/// Points per unit of area at which random sequential adsorption of disks of diameter 1 jams
/// (coverage 0.547070).
constexpr double jammed_density = 0.547070 * 4.0 / std::numbers::pi;

struct Request {
	std::string method;
	std::string precision;
	double points = 0.0;
	double side = 0.0;
	std::uint64_t seed = 0;
	double cell = 0.0;
	double darts = 100.0;
	std::uint64_t sets = 1;
	bool toroidal = false;
	bool fill = false;
	std::string dump;
};

/// The result for one set: the number of points, the cost of generating them, and the points
/// themselves if a dump is requested.
struct Outcome {
	double seconds = 0.0;
	std::uint64_t points = 0;
	std::size_t output_bytes = 0;
	DomainStats stats;
	std::vector<glm::dvec2> dumped;
};

[[noreturn]] void fail(const std::string &reason) {
	std::fprintf(stderr, "domain_run: %s\n", reason.c_str());
	std::exit(EXIT_FAILURE);
}

void require(const Status &status) {
	if (!status.ok()) {
		fail(describe(status));
	}
}

/// Returns the peak memory of this program in bytes; 0 if the system does not report it. getrusage
/// is unsuitable, because it includes the process that started this program.
std::size_t peak_resident_bytes() {
	std::ifstream status("/proc/self/status");
	std::string word;
	while (status >> word) {
		std::size_t kibibytes = 0;
		if (word == "VmHWM:" && status >> kibibytes) {
			return kibibytes * 1024;
		}
	}
	return 0;
}

/// Measures `make`, which fills a vector of points.
template <typename Point, typename Make>
Outcome timed(const Request &request, Make &&make) {
	std::vector<Point> points;
	Outcome outcome;
	const double start = cpu_seconds();
	make(points);
	outcome.seconds = cpu_seconds() - start;
	outcome.points = points.size();
	outcome.output_bytes = points.size() * sizeof(Point);
	if (!request.dump.empty()) {
		outcome.dumped.assign(points.begin(), points.end());
	}
	return outcome;
}

DomainMethod domain_method(const std::string &name) {
	return name == "naive"           ? DomainMethod::naive
			: name == "hierarchical" ? DomainMethod::hierarchical
			: name == "accumulator"  ? DomainMethod::accumulator
									 : DomainMethod::wavefront;
}

template <typename Real>
Outcome run_domain(const Request &request) {
	const DomainRequest domain{.size = glm::dvec2(request.side),
			.seed = request.seed,
			.method = domain_method(request.method),
			.toroidal = request.toroidal,
			.cell_size = request.cell,
			.darts_each = request.darts};
	DomainSampler<Real> sampler;
	Outcome outcome;
	if (request.fill) {
		const double start = cpu_seconds();
		require(sampler.fill(domain));
		outcome.seconds = cpu_seconds() - start;
		outcome.points = sampler.stats().points;
		if (!request.dump.empty()) {
			sampler.visit([&](std::span<const Real> x, std::span<const Real> y) {
				for (std::size_t i = 0; i < x.size(); ++i) {
					outcome.dumped.emplace_back(x[i], y[i]);
				}
			});
		}
	} else {
		outcome = timed<glm::vec<2, Real>>(
				request, [&](std::vector<glm::vec<2, Real>> &r_points) { require(sampler.sample(domain, r_points)); });
	}
	outcome.stats = sampler.stats();
	return outcome;
}

/// Generates a window onto the infinite set, assembled from tiles of 64 radii, as in a game.
Outcome run_tiles(const Request &request) {
	return timed<glm::dvec2>(request, [&](std::vector<glm::dvec2> &r_points) {
		constexpr double tile = 64.0;
		const PointSet set{.seed = request.seed};
		TileSampler sampler;
		std::vector<SamplePoint> kept_points;
		for (double y = 0.0; y < request.side; y += tile) {
			for (double x = 0.0; x < request.side; x += tile) {
				const glm::dvec2 corner(x, y);
				require(sampler.sample(set, {corner, glm::min(corner + tile, glm::dvec2(request.side))}, kept_points));
				for (const SamplePoint &point : kept_points) {
					r_points.push_back(point.position);
				}
			}
		}
	});
}

template <typename Method>
Outcome run_torus(const Request &request) {
	return timed<glm::dvec2>(request, [&](std::vector<glm::dvec2> &r_points) {
		Method method;
		method.sample(request.side, request.seed, r_points);
	});
}

template <typename Method>
Outcome run_bounded(const Request &request) {
	return timed<glm::vec2>(request, [&](std::vector<glm::vec2> &r_points) {
		Method method;
		method.sample(glm::vec2(static_cast<float>(request.side)), request.seed, r_points);
	});
}

Outcome run_reference(const Request &request) {
	return timed<glm::dvec2>(request, [&](std::vector<glm::dvec2> &r_points) {
		r_points = analysis::NaiveDarts(request.side, request.seed).run();
	});
}

struct Method {
	std::string_view name;
	std::function<Outcome(const Request &)> single;
	std::function<Outcome(const Request &)> as_double;
	/// True for a DomainMethod. Only a DomainMethod supports `torus`, `fill` and `cell`.
	bool is_domain = false;
};

const Method &find_method(const std::string &name) {
	static const std::array methods = {
			Method{"naive", run_domain<float>, run_domain<double>, true},
			Method{"hierarchical", run_domain<float>, run_domain<double>, true},
			Method{"accumulator", run_domain<float>, run_domain<double>, true},
			Method{"wavefront", run_domain<float>, run_domain<double>, true},
			Method{"tile", nullptr, run_tiles},
			Method{"reference", nullptr, run_reference},
			Method{"scalloped", nullptr, run_torus<ScallopedSectors>},
			Method{"boundary", nullptr, run_torus<BoundarySampling>},
			Method{"jones", nullptr, run_torus<VoronoiDarts>},
			Method{"plain_bridson", run_bounded<PlainBridson>, nullptr},
			Method{"bridson", run_bounded<Bridson>, nullptr},
	};
	for (const Method &method : methods) {
		if (method.name == name) {
			return method;
		}
	}
	fail("no such method: " + name);
}

void write_dump(const std::string &path, const std::vector<glm::dvec2> &points, bool append) {
	std::FILE *file = std::fopen(path.c_str(), append ? "ab" : "wb");
	if (file == nullptr) {
		fail("cannot write " + path);
	}
	const std::uint64_t count = points.size();
	const bool is_written = std::fwrite(&count, sizeof count, 1, file) == 1 &&
			std::fwrite(points.data(), sizeof(glm::dvec2), points.size(), file) == points.size();
	if (std::fclose(file) != 0 || !is_written) {
		fail("cannot write " + path);
	}
}

void print(const Request &request, const Outcome &outcome, std::size_t resident_before) {
	const DomainStats &stats = outcome.stats;
	const auto field = [](const char *name, auto value) {
		std::printf(", \"%s\": %llu", name, static_cast<unsigned long long>(value));
	};
	std::printf(
			"{\"method\": \"%s\", \"precision\": \"%s\", \"torus\": %s, \"fill\": %s, \"radius\": 1, \"size\": %.17g"
			", \"seconds\": %.9f, \"cell_size\": %.6f",
			request.method.c_str(), request.precision.c_str(), request.toroidal ? "true" : "false",
			request.fill ? "true" : "false", request.side, outcome.seconds, stats.cell_size);
	field("seed", request.seed);
	field("asked", request.points);
	field("points", outcome.points);
	field("darts", stats.darts);
	field("squares", stats.squares);
	field("selections", stats.selections);
	field("list_checks", stats.list_checks);
	field("discarded", stats.discarded);
	field("levels", stats.levels);
	field("grid_bytes", stats.grid_bytes);
	field("square_bytes", stats.square_bytes);
	field("workspace_bytes", stats.workspace_bytes());
	field("output_bytes", outcome.output_bytes);
	field("resident_before", resident_before);
	field("resident_peak", peak_resident_bytes());
	std::printf(", \"squares_by_level\": [");
	for (std::size_t level = 0; level < stats.squares_by_level.size(); ++level) {
		std::printf("%s%llu", level > 0 ? ", " : "", static_cast<unsigned long long>(stats.squares_by_level[level]));
	}
	std::printf("]}\n");
	std::fflush(stdout);
}

double number_of(const std::string &text, double lowest, double highest) {
	char *end = nullptr;
	const double value = std::strtod(text.c_str(), &end);
	if (text.empty() || *end != '\0' || !(value >= lowest && value <= highest)) {
		fail("not a number in its range: " + text);
	}
	return value;
}

void read_option(const std::string &text, Request &r_request) {
	const std::size_t equals = text.find('=');
	const std::string name = text.substr(0, equals);
	const std::string value = equals == std::string::npos ? "" : text.substr(equals + 1);
	if (text == "torus") {
		r_request.toroidal = true;
	} else if (text == "fill") {
		r_request.fill = true;
	} else if (name == "cell") {
		r_request.cell = number_of(value, 0.0, max_cell_size);
	} else if (name == "darts") {
		r_request.darts = number_of(value, 1.0, 1e6);
	} else if (name == "sets") {
		r_request.sets = static_cast<std::uint64_t>(number_of(value, 1.0, 1e6));
	} else if (name == "dump" && !value.empty()) {
		r_request.dump = value;
	} else {
		fail("no such option: " + text);
	}
}

Request read(const std::vector<std::string> &words) {
	if (words.size() < 4) {
		fail("usage: domain_run METHOD single|double POINTS SEED [options]; see the comment at the top of "
			 "domain_run.cpp");
	}
	Request request;
	request.method = words[0];
	request.precision = words[1];
	request.points = number_of(words[2], 100.0, max_domain_points);
	request.side = std::sqrt(request.points / jammed_density);
	request.seed = static_cast<std::uint64_t>(number_of(words[3], 0.0, 1e15));
	for (std::size_t i = 4; i < words.size(); ++i) {
		read_option(words[i], request);
	}
	return request;
}

} // namespace
} // namespace thicket::bench

int main(int argument_count, char **arguments) {
	using namespace thicket::bench;
	Request request = read(std::vector<std::string>(arguments + 1, arguments + argument_count));
	const Method &method = find_method(request.method);
	const bool is_known = request.precision == "single" || request.precision == "double";
	const auto &run = request.precision == "single" ? method.single : method.as_double;
	if (!is_known || !run) {
		fail(request.method + " has no " + request.precision + " precision");
	}
	if (!method.is_domain && (request.toroidal || request.fill || request.cell > 0.0)) {
		fail(request.method + " does not support torus, fill or cell");
	}
	const std::size_t resident_before = peak_resident_bytes();
	for (std::uint64_t set = 0; set < request.sets; ++set, ++request.seed) {
		const Outcome outcome = run(request);
		print(request, outcome, resident_before);
		if (!request.dump.empty()) {
			write_dump(request.dump, outcome.dumped, set > 0);
		}
	}
}
