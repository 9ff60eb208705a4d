// Writes point sets as raw little-endian bytes for the Python analysis, each as its count (uint64) and its records.
//   points sampler RADIUS LEVELS LAYER MIN_X MIN_Y MAX_X MAX_Y TILE FIRST_SEED SEEDS
//       the tile sampler, in meters; TILE 0 asks for the rectangle at once, otherwise it is put together from tiles.
//       Record: lattice x, lattice y (int64), id (uint64), rank, level (uint32).
//   points darts SIDE FIRST_SEED SEEDS            naive dart throwing run to its end on a torus, in radii
//   points progressive SIDE LEVELS FIRST_SEED SEEDS   the same for a progressive set
//   points colored SIDE TILE FIRST_SEED SEEDS    four phases of colored tiles: packs too densely along its seams
//   points bridson SIDE FIRST_SEED SEEDS          Bridson's method on a square: not dart throwing
//   points domain METHOD PRECISION WIDTH HEIGHT TORUS DARTS_EACH FIRST_SEED SEEDS
//       the single-domain sampler, radius 1: METHOD as in DomainMethod, PRECISION single or double, TORUS 0 or 1.
//       Record: x, y (float64).

#include "tests/analysis/naive_darts.hpp"
#include "tests/bench/common/bridson.hpp"

#include "core/sampling/domain/domain_sampler.hpp"
#include "core/sampling/tile_sampler.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string>
#include <vector>

namespace thicket::analysis {
namespace {

/// What the Python side reads for one point of the sampler.
struct Record {
	std::int64_t x;
	std::int64_t y;
	std::uint64_t id;
	std::uint32_t rank;
	std::uint32_t level;
};
static_assert(sizeof(Record) == 32);

/// The words of the command line, taken one by one.
class Arguments {
public:
	explicit Arguments(std::span<char *> words) : words_(words) {}

	std::string word() {
		if (next_ == words_.size()) {
			std::fprintf(stderr, "points: too few arguments, see the head of points.cpp\n");
			std::exit(EXIT_FAILURE);
		}
		return words_[next_++];
	}
	double number() { return std::strtod(word().c_str(), nullptr); }
	std::uint64_t whole() { return std::strtoull(word().c_str(), nullptr, 10); }

private:
	std::span<char *> words_;
	std::size_t next_ = 1;
};

template <typename Item>
void write(std::span<const Item> items) {
	const std::uint64_t count = items.size();
	std::fwrite(&count, sizeof count, 1, stdout);
	if (std::fwrite(items.data(), sizeof(Item), items.size(), stdout) != items.size()) {
		std::perror("points");
		std::exit(EXIT_FAILURE);
	}
}

void require(const Status &status) {
	if (!status.ok()) {
		std::fprintf(stderr, "points: %s\n", describe(status).c_str());
		std::exit(EXIT_FAILURE);
	}
}

/// Appends the records of one rectangle.
void sample_into(TileSampler &sampler, const PointSet &set, const Rect &rect, std::vector<Record> &r_records) {
	static std::vector<SamplePoint> points;
	require(sampler.sample(set, rect, points));
	for (const SamplePoint &point : points) {
		const glm::i64vec2 at = lattice_position(set, point);
		r_records.push_back({at.x, at.y, point.id, point.rank, point.level});
	}
}

void write_sampler(Arguments &arguments) {
	PointSet set;
	set.radius = arguments.number();
	set.levels = static_cast<std::uint32_t>(arguments.whole());
	set.layer = static_cast<std::uint16_t>(arguments.whole());
	Rect rect;
	rect.min.x = arguments.number();
	rect.min.y = arguments.number();
	rect.max.x = arguments.number();
	rect.max.y = arguments.number();
	const double tile = arguments.number();
	set.seed = arguments.whole();
	const std::uint64_t end = set.seed + arguments.whole();
	const glm::dvec2 step = tile > 0.0 ? glm::dvec2(tile) : rect.size();
	TileSampler sampler;
	std::vector<Record> records;
	for (; set.seed < end; ++set.seed) {
		records.clear();
		for (double y = rect.min.y; y < rect.max.y; y += step.y) {
			for (double x = rect.min.x; x < rect.max.x; x += step.x) {
				const glm::dvec2 corner(x, y);
				const glm::dvec2 far_corner(std::min(x + step.x, rect.max.x), std::min(y + step.y, rect.max.y));
				sample_into(sampler, set, {corner, far_corner}, records);
			}
		}
		write(std::span<const Record>(records));
	}
}

DomainMethod method_of(const std::string &name) {
	constexpr std::array names = {"naive", "hierarchical", "accumulator", "wavefront"};
	const auto *const found = std::find(names.begin(), names.end(), name);
	if (found == names.end()) {
		std::fprintf(stderr, "points: no such method: %s\n", name.c_str());
		std::exit(EXIT_FAILURE);
	}
	return static_cast<DomainMethod>(found - names.begin());
}

template <typename Real>
void write_domains(DomainRequest request, std::uint64_t end) {
	DomainSampler<Real> sampler;
	std::vector<glm::vec<2, Real>> points;
	for (; request.seed < end; ++request.seed) {
		require(sampler.sample(request, points));
		write(std::span<const glm::dvec2>(std::vector<glm::dvec2>(points.begin(), points.end())));
	}
}

void write_domain(Arguments &arguments) {
	DomainRequest request;
	request.method = method_of(arguments.word());
	const bool single = arguments.word() == "single";
	request.size.x = arguments.number();
	request.size.y = arguments.number();
	request.toroidal = arguments.whole() != 0;
	request.darts_each = arguments.number();
	request.seed = arguments.whole();
	const std::uint64_t end = request.seed + arguments.whole();
	if (single) {
		write_domains<float>(request, end);
	} else {
		write_domains<double>(request, end);
	}
}

double phase_tile = 16.0;

int phase_of(glm::dvec2 middle) {
	return (static_cast<int>(middle.x / phase_tile) & 1) + 2 * (static_cast<int>(middle.y / phase_tile) & 1);
}

void write_reference(const std::string &kind, Arguments &arguments) {
	const double side = arguments.number();
	phase_tile = kind == "colored" ? arguments.number() : phase_tile;
	const auto levels = kind == "progressive" ? static_cast<std::uint32_t>(arguments.whole()) : 1u;
	const std::uint64_t first = arguments.whole();
	const std::uint64_t count = arguments.whole();
	for (std::uint64_t seed = first; seed < first + count; ++seed) {
		std::vector<glm::dvec2> points;
		if (kind == "darts") {
			points = NaiveDarts(side, seed).run();
		} else if (kind == "progressive") {
			points = naive_progressive(side, levels, seed);
		} else if (kind == "colored") {
			points = NaiveDarts(side, seed).run_in_phases(4, phase_of);
		} else {
			std::vector<glm::vec2> floats;
			bench::Bridson().sample(glm::vec2(static_cast<float>(side)), seed, floats);
			points.assign(floats.begin(), floats.end());
		}
		write(std::span<const glm::dvec2>(points));
	}
}

} // namespace
} // namespace thicket::analysis

int main(int argument_count, char **arguments) {
	using namespace thicket::analysis;
	Arguments words(std::span(arguments, static_cast<std::size_t>(argument_count)));
	const std::string kind = words.word();
	if (kind == "sampler") {
		write_sampler(words);
	} else if (kind == "domain") {
		write_domain(words);
	} else if (kind == "darts" || kind == "progressive" || kind == "colored" || kind == "bridson") {
		write_reference(kind, words);
	} else {
		std::fprintf(stderr, "points: no such kind of set: %s\n", kind.c_str());
		return EXIT_FAILURE;
	}
	return EXIT_SUCCESS;
}
