#pragma once

#include "core/base/status.hpp"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace thicket::cost {

using Points = std::vector<glm::dvec2>;

/// Generates inputs of one kind, in any size.
class Recipe {
public:
	explicit Recipe(std::uint64_t seed);

	/// Returns points in a difficult arrangement: all at one position, alternating between two
	/// positions, along lines, at random, on a spiral, or on a grid.
	Points points(std::size_t count) const;

	/// Returns distinct IDs of points.
	std::vector<std::uint64_t> ids(std::size_t count) const;

	const char *name() const;
	double step() const { return step_; }

private:
	enum class Kind : std::uint8_t { one_position, two_positions, line, line_back, crowd, wide, star, comb, grid };
	static constexpr std::size_t kinds = 9;

	std::uint64_t seed_;
	Kind kind_ = Kind::one_position;
	double step_ = 1.0;
	std::uint64_t stride_ = 1;
};

/// Returns positions that are the same for every input size.
Points fixed_positions();

/// Ends the program if `status` is an error.
void need(const Status &status);

/// Runs `work` and returns the number of steps that it takes.
std::uint64_t steps_of(const std::function<void()> &work);

/// A case with a name. `run` returns the number of steps for an input of size `count`.
struct Case {
	const char *name;
	std::uint64_t (*run)(const Recipe &recipe, std::size_t count);
};

std::span<const Case> cases_of_states();
std::span<const Case> cases_of_masks();
std::span<const Case> cases_of_regions();
std::span<const Case> cases_of_meshes();

} // namespace thicket::cost
