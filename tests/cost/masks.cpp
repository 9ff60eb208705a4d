#include "tests/cost/growth.hpp"

#include "core/rules/painted_mask.hpp"

#include <array>

namespace thicket::cost {

namespace {

/// Returns a mask with `count` dabs of equal size. Its pixels are 1 m wide.
PaintedMask painted(const Recipe &recipe, std::size_t count) {
	PaintedMask mask;
	need(mask.reset(1.0, 0.0));
	for (const glm::dvec2 &center : recipe.points(count)) {
		Rect changed_rect;
		Brush brush;
		brush.center = center;
		brush.radius = 3.0;
		need(mask.paint(brush, changed_rect));
	}
	return mask;
}

constexpr std::size_t dabs_divisor = 8; // One dab takes many steps.

std::uint64_t paint(const Recipe &recipe, std::size_t count) {
	return steps_of([&] { painted(recipe, count / dabs_divisor); });
}

std::uint64_t save_and_load_mask(const Recipe &recipe, std::size_t count) {
	const PaintedMask mask = painted(recipe, count / dabs_divisor);
	return steps_of([&] {
		PaintedMask loaded_mask;
		need(loaded_mask.from_bytes(mask.to_bytes()));
	});
}

constexpr std::array cases = {
		Case{"mask: dabs", paint},
		Case{"mask: save and load", save_and_load_mask},
};

} // namespace

std::span<const Case> cases_of_masks() { return cases; }

} // namespace thicket::cost
