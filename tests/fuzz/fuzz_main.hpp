#pragma once

// A fuzz target is a file with LLVMFuzzerTestOneInput. With clang, `-fsanitize=fuzzer
// -DTHICKET_LIBFUZZER` makes it a libFuzzer program:
//   clang++ -std=c++20 -g -O1 -fsanitize=fuzzer,address,undefined -DTHICKET_LIBFUZZER -ffp-contract=off -Iextension -I.
//       extension/core/*/*.cpp extension/core/*/*/*.cpp tests/fuzz/fuzz_sampler.cpp -lhwy -llodepng -o build/fuzz_sampler
// Without -DTHICKET_LIBFUZZER, the `main` below runs the target with random bytes:
//   fuzz_sampler [seconds = 10] [seed = 1]      many inputs
//   fuzz_sampler - SEED                         the one input that a failure printed

#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <unistd.h>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size);

namespace thicket::fuzz {

inline std::uint64_t current_seed = 0; ///< The seed of the current input, for failure messages.

/// Aborts the program with a message if a requirement is not met.
inline void require(bool is_met, const char *requirement) {
	if (!is_met) {
		std::fprintf(stderr, "fuzz: violated requirement: %s (again with: - %llu)\n", requirement,
				static_cast<unsigned long long>(current_seed));
		std::abort();
	}
}

} // namespace thicket::fuzz

#ifndef THICKET_LIBFUZZER

namespace thicket::fuzz {

inline void run_one(std::uint64_t seed) {
	current_seed = seed;
	std::mt19937_64 random(seed);
	std::vector<std::uint8_t> bytes(64 + random() % 512);
	for (std::uint8_t &byte : bytes) {
		byte = static_cast<std::uint8_t>(random());
	}
	LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
}

/// A run that takes longer than this is considered a hang.
inline constexpr unsigned hang_seconds = 20;

} // namespace thicket::fuzz

int main(int argument_count, char **arguments) {
	using namespace thicket::fuzz;
	const bool single_input = argument_count > 2 && std::strcmp(arguments[1], "-") == 0;
	if (single_input) {
		run_one(std::strtoull(arguments[2], nullptr, 10));
		return EXIT_SUCCESS;
	}
	const double seconds = argument_count > 1 ? std::atof(arguments[1]) : 10.0;
	std::uint64_t seed = argument_count > 2 ? std::strtoull(arguments[2], nullptr, 10) : 1;
	std::signal(SIGALRM, [](int) { require(false, "an input does not hang"); });
	const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
	std::uint64_t runs = 0;
	for (; std::chrono::steady_clock::now() < end; ++runs, ++seed) {
		alarm(hang_seconds);
		run_one(seed);
	}
	alarm(0);
	std::printf("%llu inputs\n", static_cast<unsigned long long>(runs));
}

#endif
