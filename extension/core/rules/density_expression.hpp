#pragma once

#include "core/rules/world_input.hpp"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace thicket {

/// A value that an expression can use.
enum class ExpressionInput : std::uint8_t {
	height,      ///< World height of the ground in meters, or its altitude on a planet.
	slope,       ///< Slope of the ground in degrees, 0 to 180.
	water_depth, ///< Depth of the ground below the water in meters; minus infinity without water.
	x,           ///< World coordinates in meters.
	z,
};
inline constexpr std::size_t expression_input_count = 5;

/// The values of all inputs at one position. Inputs that the expression does not use may be left
/// out.
struct ExpressionInputs {
	double height = 0.0;
	double slope = 0.0;
	double water_depth = 0.0;
	glm::dvec3 position{0.0}; ///< World position in meters; y matters only for noise in space.
	/// The value of each of DensityExpression::world_inputs.
	std::span<const float> world{};
};

/// The reason why a text is not a valid expression.
struct ExpressionError {
	std::size_t column = 0; ///< Position in the text, starting at 1.
	std::string message;    ///< A sentence that says how to fix the error, without a period.
};

inline constexpr std::size_t max_expression_length = 1000; ///< In bytes.

/// A density in one line of text, such as "smoothstep(900, 1200, height) * noise(40)". Immutable,
/// so threads may share one object. The class reference documents the language
/// (ScatterLayer.density_expression).
///
/// The text is compiled into operations on a stack. All of them are IEEE operations or comparisons,
/// so the result is bit-identical on all platforms. It may be outside 0 to 1, infinite or NAN.
class DensityExpression {
public:
	/// Compiles a text. If it is invalid, returns null and sets `r_error`. Throws std::bad_alloc.
	static std::shared_ptr<const DensityExpression> compile(std::string_view text, ExpressionError &r_error);

	const std::string &text() const { return text_; }
	bool uses(ExpressionInput input) const { return uses_[static_cast<std::size_t>(input)]; }

	/// Returns the inputs that the layer provides, each once, at most max_world_inputs.
	std::span<const WorldInput> world_inputs() const { return world_inputs_; }

	/// Returns the value at a position. `seed` selects the noise. If `in_space` is true, the noise
	/// also depends on y.
	double at(const ExpressionInputs &inputs, std::uint64_t seed, bool in_space) const;

private:
	friend class ExpressionParser;

	/// Largest number of values on the stack during an evaluation.
	static constexpr std::size_t max_depth = 16;

	enum class Operation : std::uint8_t {
		constant,
		input,
		world_input,
		noise,
		negate,
		add,
		subtract,
		multiply,
		divide,
		less,
		less_or_equal,
		greater,
		greater_or_equal,
		absolute,
		floor,
		square_root,
		min,
		max,
		clamp,
		lerp,
		inverse_lerp,
		smoothstep,
	};
	struct Step {
		Operation operation = Operation::constant;
		ExpressionInput input = ExpressionInput::height;
		std::uint8_t world_input = 0; ///< Index in world_inputs_.
		double number = 0.0;          ///< The constant, or the size of the noise in meters.
	};

	static double run(
			const Step *steps, std::size_t count, const ExpressionInputs &inputs, std::uint64_t seed, bool in_space);

	std::string text_;
	std::vector<Step> steps_;
	std::vector<WorldInput> world_inputs_;
	bool uses_[expression_input_count] = {};
};

} // namespace thicket
