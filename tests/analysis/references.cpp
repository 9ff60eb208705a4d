// Writes reference point sets to stdout. The Python analysis compares the sampler's sets with them.
// Each set is written as raw little-endian bytes: the count (uint64), then the coordinates in radii
// (float64 x, y).
//   references darts SIDE FIRST_SEED SEEDS                naive dart throwing on a torus until the set is maximal
//   references progressive SIDE LEVELS FIRST_SEED SEEDS   the same for a progressive set
//   references colored SIDE TILE FIRST_SEED SEEDS         tiles filled in four phases: too dense along the seams
//   references bridson SIDE FIRST_SEED SEEDS              Bridson's method on a square: not dart throwing

#include "tests/analysis/naive_darts.hpp"
#include "tests/bench/common/bridson.hpp"

#include <cstdio>
#include <cstdlib>
#include <span>
#include <string>
#include <vector>

namespace thicket::analysis {
namespace {

/// Reads the command-line arguments one by one. Exits if one is missing.
class Arguments {
public:
	explicit Arguments(std::span<char *> words) : words_(words) {}

	std::string word() {
		if (next_ == words_.size()) {
			std::fprintf(stderr, "references: too few arguments; see the comment at the top of references.cpp\n");
			std::exit(EXIT_FAILURE);
		}
		return words_[next_++];
	}
	double number() { return std::strtod(word().c_str(), nullptr); }
	std::uint64_t integer() { return std::strtoull(word().c_str(), nullptr, 10); }

private:
	std::span<char *> words_;
	std::size_t next_ = 1;
};

void write(const std::vector<glm::dvec2> &points) {
	const std::uint64_t count = points.size();
	std::fwrite(&count, sizeof count, 1, stdout);
	if (std::fwrite(points.data(), sizeof(glm::dvec2), points.size(), stdout) != points.size()) {
		std::perror("references");
		std::exit(EXIT_FAILURE);
	}
}

double phase_tile = 16.0;

int phase_of(glm::dvec2 middle) {
	return (static_cast<int>(middle.x / phase_tile) & 1) + 2 * (static_cast<int>(middle.y / phase_tile) & 1);
}

void write_sets(const std::string &kind, Arguments &arguments) {
	const double side = arguments.number();
	phase_tile = kind == "colored" ? arguments.number() : phase_tile;
	const auto levels = kind == "progressive" ? static_cast<std::uint32_t>(arguments.integer()) : 1u;
	const std::uint64_t first = arguments.integer();
	const std::uint64_t count = arguments.integer();
	for (std::uint64_t seed = first; seed < first + count; ++seed) {
		if (kind == "darts") {
			write(NaiveDarts(side, seed).run());
		} else if (kind == "progressive") {
			write(naive_progressive(side, levels, seed));
		} else if (kind == "colored") {
			write(NaiveDarts(side, seed).run_in_phases(4, phase_of));
		} else {
			std::vector<glm::vec2> points;
			bench::Bridson().sample(glm::vec2(static_cast<float>(side)), seed, points);
			write(std::vector<glm::dvec2>(points.begin(), points.end()));
		}
	}
}

} // namespace
} // namespace thicket::analysis

int main(int argument_count, char **arguments) {
	using namespace thicket::analysis;
	Arguments words(std::span(arguments, static_cast<std::size_t>(argument_count)));
	const std::string kind = words.word();
	if (kind != "darts" && kind != "progressive" && kind != "colored" && kind != "bridson") {
		std::fprintf(stderr, "references: no such kind of set: %s\n", kind.c_str());
		return EXIT_FAILURE;
	}
	write_sets(kind, words);
	return EXIT_SUCCESS;
}
