#include "core/rules/density_expression.hpp"

#include "core/base/floating_point.hpp"
#include "core/rules/clump_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace thicket {

namespace {

double smoothstep(double from, double to, double value) {
	if (from == to) {
		return value < from ? 0.0 : 1.0;
	}
	const double fraction = std::clamp((value - from) / (to - from), 0.0, 1.0);
	return fraction * fraction * (3.0 - 2.0 * fraction);
}

} // namespace

double DensityExpression::at(const ExpressionInputs &inputs, std::uint64_t seed, bool in_space) const {
	return run(steps_.data(), steps_.size(), inputs, seed, in_space);
}

double DensityExpression::run(
		const Step *steps, std::size_t count, const ExpressionInputs &inputs, std::uint64_t seed, bool in_space) {
	// The parser has checked the depth. `top` points to the last value.
	std::array<double, max_depth + 1> stack;
	double *top = stack.data();
	*top = 0.0;
	for (const Step *step = steps; step != steps + count; ++step) {
		switch (step->operation) {
			case Operation::constant: *++top = step->number; break;
			case Operation::input:
				switch (step->input) {
					case ExpressionInput::height: *++top = inputs.height; break;
					case ExpressionInput::slope: *++top = inputs.slope; break;
					case ExpressionInput::water_depth: *++top = inputs.water_depth; break;
					case ExpressionInput::x: *++top = inputs.position.x; break;
					case ExpressionInput::z: *++top = inputs.position.z; break;
				}
				break;
			case Operation::world_input: *++top = double{inputs.world[step->world_input]}; break;
			case Operation::noise:
				*++top = in_space ? uniform_noise(inputs.position, step->number, seed)
								  : uniform_noise(glm::dvec2(inputs.position.x, inputs.position.z), step->number, seed);
				break;
			case Operation::negate: *top = -*top; break;
			case Operation::absolute: *top = std::abs(*top); break;
			case Operation::floor: *top = std::floor(*top); break;
			case Operation::square_root: *top = std::sqrt(*top); break;
			case Operation::add:
				--top;
				top[0] += top[1];
				break;
			case Operation::subtract:
				--top;
				top[0] -= top[1];
				break;
			case Operation::multiply:
				--top;
				top[0] *= top[1];
				break;
			case Operation::divide:
				--top;
				top[0] /= top[1];
				break;
			case Operation::less:
				--top;
				top[0] = top[0] < top[1] ? 1.0 : 0.0;
				break;
			case Operation::less_or_equal:
				--top;
				top[0] = top[0] <= top[1] ? 1.0 : 0.0;
				break;
			case Operation::greater:
				--top;
				top[0] = top[0] > top[1] ? 1.0 : 0.0;
				break;
			case Operation::greater_or_equal:
				--top;
				top[0] = top[0] >= top[1] ? 1.0 : 0.0;
				break;
			case Operation::min:
				--top;
				top[0] = top[1] < top[0] ? top[1] : top[0];
				break;
			case Operation::max:
				--top;
				top[0] = top[1] > top[0] ? top[1] : top[0];
				break;
			case Operation::clamp:
				top -= 2;
				top[0] = top[0] < top[1] ? top[1] : top[0] > top[2] ? top[2] : top[0];
				break;
			case Operation::lerp:
				top -= 2;
				top[0] = top[0] + (top[1] - top[0]) * top[2];
				break;
			case Operation::inverse_lerp:
				top -= 2;
				top[0] = (top[2] - top[0]) / (top[1] - top[0]);
				break;
			case Operation::smoothstep:
				top -= 2;
				top[0] = smoothstep(top[0], top[1], top[2]);
				break;
		}
	}
	return *top;
}

} // namespace thicket
