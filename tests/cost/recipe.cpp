#include "tests/cost/growth.hpp"

#include "tests/cost/steps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>

namespace thicket::cost {

namespace {

/// Returns a random number in [0, 1).
double unit(std::mt19937_64 &r_random) { return static_cast<double>(r_random() >> 11) * 0x1p-53; }

} // namespace

Recipe::Recipe(std::uint64_t seed) : seed_(seed) {
	std::mt19937_64 random(seed);
	kind_ = static_cast<Kind>(random() % kinds);
	step_ = std::exp2(12.0 * unit(random) - 6.0);
	stride_ = random() % 3 == 0 ? std::uint64_t{1} << random() % 40 : 1 + random() % 1000;
}

Points Recipe::points(std::size_t count) const {
	std::mt19937_64 own(seed_);
	const auto any = [&own] {
		return unit(own) - 0.5;
	};
	Points result;
	for (std::size_t i = 0; i < count; ++i) {
		const auto at = static_cast<double>(i);
		switch (kind_) {
			case Kind::one_position: result.emplace_back(3.0, 4.0); break;
			case Kind::two_positions: result.emplace_back(i % 2 == 0 ? -step_ : step_, 0.0); break;
			case Kind::line: result.emplace_back(step_ * at, 0.0); break;
			case Kind::line_back: result.emplace_back(step_ * (static_cast<double>(count) - at), step_); break;
			case Kind::crowd: result.emplace_back(step_ * any(), step_ * any()); break;
			case Kind::wide: result.emplace_back(1e5 * any(), 1e5 * any()); break;
			case Kind::star: result.emplace_back(i % 2 == 0 ? 0.0 : 1e3 * any(), i % 2 == 0 ? 0.0 : 1e3 * any()); break;
			case Kind::comb: result.emplace_back(step_ * at, (i / 2) % 2 == 0 ? 0.0 : 1e3); break;
			default:
				result.emplace_back(step_ * static_cast<double>(i % 32), step_ * static_cast<double>(i / 32));
				break;
		}
	}
	return result;
}

std::vector<std::uint64_t> Recipe::ids(std::size_t count) const {
	std::vector<std::uint64_t> result;
	for (std::size_t i = 0; i < count; ++i) {
		const std::uint64_t index = stride_ * (i + 1);
		const auto layer = static_cast<std::uint64_t>(kind_) % 3 == 0 ? i % 5 : 0;
		result.push_back(layer << 48 | (index & 0xffffffffffff));
	}
	std::ranges::sort(result);
	result.erase(std::unique(result.begin(), result.end()), result.end());
	return result;
}

const char *Recipe::name() const {
	static constexpr std::array<const char *, kinds> names = {
			"one place", "two places", "line", "line back", "crowd", "wide", "star", "comb", "grid"};
	return names[static_cast<std::size_t>(kind_)];
}

Points fixed_positions() {
	Points positions;
	for (int i = 0; i < 16; ++i) {
		positions.emplace_back(-500.0 + 70.0 * i, 3.0 * i);
	}
	return positions;
}

void need(const Status &status) {
	if (!status.ok()) {
		std::fprintf(stderr, "growth: an input was rejected: %s\n", describe(status).c_str());
		std::abort();
	}
}

std::uint64_t steps_of(const std::function<void()> &work) {
	const std::uint64_t before = steps();
	work();
	return steps() - before;
}

} // namespace thicket::cost
