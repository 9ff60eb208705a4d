// Measures how costs grow. Each case runs with random kinds of input at two sizes, and its cost is
// measured in steps instead of time. Four times the input must take at most six times the steps.
// For a cost of n log n, the factor stays below five; for a quadratic cost, it reaches sixteen.
//   growth [ROUNDS = 3] [SEED = 1]      rounds of all cases, each with a new seed
//   growth - SEED [CASE]                repeats a failure with its seed and prints the steps of all cases, or of one

#include "tests/cost/growth.hpp"

#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

using namespace thicket::cost;

constexpr std::size_t small_size = 1024;
constexpr std::size_t growth = 4;
constexpr double max_growth = 6.0;

/// Added to the steps at both sizes, so that small counts do not exceed the limit.
constexpr std::uint64_t free_steps = 20000;

std::vector<Case> all_cases() {
	std::vector<Case> all;
	for (const std::span<const Case> case_list :
			{cases_of_states(), cases_of_masks(), cases_of_regions(), cases_of_meshes()}) {
		all.insert(all.end(), case_list.begin(), case_list.end());
	}
	return all;
}

/// Returns false, and prints a line, if the cost of a case grows too fast.
bool check(const Case &test_case, std::uint64_t seed, bool verbose) {
	const Recipe recipe(seed);
	// Builds everything that is built only once, such as tables of the library, before the
	// measurements.
	static_cast<void>(test_case.run(recipe, small_size));
	const std::uint64_t few = test_case.run(recipe, small_size) + free_steps;
	const std::uint64_t large_steps = test_case.run(recipe, growth * small_size) + free_steps;
	const double ratio = static_cast<double>(large_steps) / static_cast<double>(few);
	const bool is_within_limit = ratio <= max_growth;
	if (!is_within_limit || verbose) {
		std::printf("%s, %s: %llu steps for %zu, %llu for %zu, %.1f times as many%s (again with: - %llu)\n",
				test_case.name, recipe.name(), static_cast<unsigned long long>(few), small_size,
				static_cast<unsigned long long>(large_steps), growth * small_size, ratio,
				is_within_limit ? "" : ": TOO MANY", static_cast<unsigned long long>(seed));
	}
	return is_within_limit;
}

} // namespace

int main(int argument_count, char **arguments) {
	const bool single_round = argument_count > 2 && std::strcmp(arguments[1], "-") == 0;
	const int rounds = single_round || argument_count < 2 ? (single_round ? 1 : 3) : std::atoi(arguments[1]);
	const char *case_name = single_round && argument_count > 3 ? arguments[3] : nullptr;
	const std::uint64_t seed = argument_count > 2 ? std::strtoull(arguments[2], nullptr, 10) : 1;
	const std::vector<Case> cases = all_cases();
	int failed_count = 0;
	for (int round = 0; round < rounds; ++round) {
		for (const Case &test_case : cases) {
			const bool chosen = case_name == nullptr || std::strcmp(test_case.name, case_name) == 0;
			failed_count += !chosen || check(test_case, seed + static_cast<std::uint64_t>(round), single_round) ? 0 : 1;
		}
	}
	std::printf("%zu cases, %d rounds, %d failed\n", cases.size(), rounds, failed_count);
	return failed_count == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
