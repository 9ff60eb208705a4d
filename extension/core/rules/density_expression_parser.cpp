#include "core/rules/biome_map.hpp"
#include "core/rules/clump_noise.hpp"
#include "core/rules/density_expression.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

namespace thicket {

namespace {

/// Largest number of nested parentheses, so that the parser's recursion is bounded.
constexpr std::size_t max_nesting = 50;

/// Numbers with more digits or larger exponents cannot be converted by one exact operation.
constexpr double max_digits_value = 1e15;
constexpr int max_exponent = 22;

constexpr std::array<std::string_view, expression_input_count> input_names{"height", "slope", "water_depth", "x", "z"};
constexpr const char *input_list = "height, slope, water_depth, x, z, mask_red, mask_green, mask_blue and mask_alpha";
constexpr const char *function_list =
		"abs, floor, sqrt, min, max, clamp, lerp, inverse_lerp, smoothstep, noise, biome, "
		"texture and distance";

constexpr double max_biome_number = static_cast<double>(max_biomes - 1);

bool is_digit(char character) { return character >= '0' && character <= '9'; }

bool is_letter(char character) {
	return (character >= 'a' && character <= 'z') || (character >= 'A' && character <= 'Z') || character == '_';
}

} // namespace

/// A parser by recursive descent. It appends operations in the order in which the stack needs them.
class ExpressionParser {
public:
	explicit ExpressionParser(std::string_view text, ExpressionError &r_error) : text_(text), error_(r_error) {}

	bool parse(DensityExpression &r_expression) {
		if (text_.size() > max_expression_length) {
			return fail("an expression must have at most " + std::to_string(max_expression_length) +
					" characters, got " + std::to_string(text_.size()));
		}
		if (!comparison()) {
			return false;
		}
		skip_spaces();
		if (at_ < text_.size()) {
			return fail("expected an operator, got \"" + std::string(1, text_[at_]) +
					"\": use + - * / < <= > or >=, or remove it");
		}
		r_expression.steps_ = std::move(steps_);
		r_expression.world_inputs_ = std::move(world_inputs_);
		for (const Step &step : r_expression.steps_) {
			if (step.operation == Operation::input) {
				r_expression.uses_[static_cast<std::size_t>(step.input)] = true;
			} else if (step.operation == Operation::noise) {
				uses_position(r_expression);
			}
		}
		r_expression.text_ = text_;
		return true;
	}

private:
	using Operation = DensityExpression::Operation;
	using Step = DensityExpression::Step;

	struct Function {
		std::string_view name;
		Operation operation;
		std::size_t arguments;
	};
	static constexpr std::array functions{
			Function{"abs", Operation::absolute, 1},
			Function{"floor", Operation::floor, 1},
			Function{"sqrt", Operation::square_root, 1},
			Function{"min", Operation::min, 2},
			Function{"max", Operation::max, 2},
			Function{"clamp", Operation::clamp, 3},
			Function{"lerp", Operation::lerp, 3},
			Function{"inverse_lerp", Operation::inverse_lerp, 3},
			Function{"smoothstep", Operation::smoothstep, 3},
			Function{"noise", Operation::noise, 1},
	};

	/// A function whose arguments name a source and are not expressions.
	struct WorldFunction {
		std::string_view name;
		WorldInputKind kind;
		const char *remedy;
	};
	static constexpr std::array world_functions{
			WorldFunction{"biome", WorldInputKind::biome,
					"biome must have the name of a biome, or its index between 0 and 31, for example "
					"biome(\"Forest\")"},
			WorldFunction{"texture", WorldInputKind::texture,
					"texture must have the number of a texture between 0 and 255, for example texture(3)"},
			WorldFunction{"distance", WorldInputKind::distance,
					"distance must have the name of a layer and a maximum distance between 0.001 and 1000 m, for "
					"example distance(\"Oaks\", 20)"},
	};

	static void uses_position(DensityExpression &r_expression) {
		for (const ExpressionInput input : {ExpressionInput::x, ExpressionInput::z}) {
			r_expression.uses_[static_cast<std::size_t>(input)] = true;
		}
	}

	bool fail(std::string message) { return fail_at(at_, std::move(message)); }
	bool fail_at(std::size_t at, std::string message) {
		error_ = {at + 1, std::move(message)};
		return false;
	}

	void skip_spaces() {
		while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n')) {
			++at_;
		}
	}

	/// Skips a symbol if it comes next.
	bool take(std::string_view symbol) {
		skip_spaces();
		if (text_.substr(at_, symbol.size()) != symbol) {
			return false;
		}
		at_ += symbol.size();
		return true;
	}

	bool push(const Step &step) {
		steps_.push_back(step);
		++depth_;
		return depth_ <= DensityExpression::max_depth ||
				fail("the expression is too deeply nested: at most " + std::to_string(DensityExpression::max_depth) +
						" values may wait for an operation. Reorder or simplify it");
	}

	/// Appends an operation on the last `arguments` values, or replaces it by its result if these
	/// are constants.
	void apply(Operation operation, std::size_t arguments) {
		depth_ -= arguments - 1;
		const bool is_constant = std::all_of(steps_.end() - static_cast<std::ptrdiff_t>(arguments), steps_.end(),
				[](const Step &step) { return step.operation == Operation::constant; });
		steps_.push_back({.operation = operation});
		if (is_constant) {
			const std::size_t first = steps_.size() - arguments - 1;
			const double result = DensityExpression::run(steps_.data() + first, arguments + 1, {}, 0, false);
			steps_.resize(first);
			steps_.push_back({.number = result});
		}
	}

	using Symbol = std::pair<std::string_view, Operation>;

	/// Parses operands and the operators between them, at most `most_operators`. Operators apply from
	/// left to right. If a symbol begins with another one, it must come first.
	bool operations(std::span<const Symbol> symbols, bool (ExpressionParser::*operand)(),
			std::size_t most_operators = max_expression_length) {
		bool is_parsed = (this->*operand)();
		for (std::size_t count = 0; is_parsed && count < most_operators; ++count) {
			const auto symbol = std::ranges::find_if(symbols, [this](const Symbol &each) { return take(each.first); });
			if (symbol == symbols.end()) {
				break;
			}
			is_parsed = (this->*operand)();
			if (is_parsed) {
				apply(symbol->second, 2);
			}
		}
		return is_parsed;
	}

	bool comparison() {
		constexpr std::array<Symbol, 4> symbols{{{"<=", Operation::less_or_equal}, {">=", Operation::greater_or_equal},
				{"<", Operation::less}, {">", Operation::greater}}};
		return operations(symbols, &ExpressionParser::sum, 1);
	}

	bool sum() {
		constexpr std::array<Symbol, 2> symbols{{{"+", Operation::add}, {"-", Operation::subtract}}};
		return operations(symbols, &ExpressionParser::product);
	}

	bool product() {
		constexpr std::array<Symbol, 2> symbols{{{"*", Operation::multiply}, {"/", Operation::divide}}};
		return operations(symbols, &ExpressionParser::factor);
	}

	bool factor() {
		bool is_negative = false;
		while (take("-")) {
			is_negative = !is_negative;
		}
		if (!primary()) {
			return false;
		}
		if (is_negative) {
			apply(Operation::negate, 1);
		}
		return true;
	}

	bool primary() {
		skip_spaces();
		if (at_ == text_.size()) {
			return fail("the expression ends too early: add a number, an input or a function");
		}
		const char next = text_[at_];
		if (is_digit(next) || next == '.') {
			return number();
		}
		if (is_letter(next)) {
			return named();
		}
		if (!take("(")) {
			return fail("expected a number, an input or a function, got \"" + std::string(1, next) + "\"");
		}
		return nested([this] { return comparison(); }) && close();
	}

	template <class Parse>
	bool nested(const Parse &parse) {
		if (nesting_ == max_nesting) {
			return fail_at(at_ - 1,
					"the expression is too deeply nested: at most " + std::to_string(max_nesting) +
							" parentheses may be open");
		}
		++nesting_;
		const bool is_parsed = parse();
		--nesting_;
		return is_parsed;
	}

	bool close() { return take(")") || fail("expected \")\""); }

	bool number() {
		const std::size_t start = at_;
		const std::optional<double> value = read_number();
		return value.has_value() ? push({.number = *value})
								 : fail_at(start,
										   "not a number that can be used: it must have at most 15 digits and an "
										   "exponent of at most 22");
	}

	/// Reads a number. A mantissa below 2^53 and a power of ten up to 10^22 are exact doubles, so a
	/// single operation returns the double nearest to the text.
	std::optional<double> read_number() {
		double digits = 0.0;
		int exponent = 0;
		bool has_digit = false;
		bool has_point = false;
		for (; at_ < text_.size() && (is_digit(text_[at_]) || (text_[at_] == '.' && !has_point)); ++at_) {
			if (text_[at_] == '.') {
				has_point = true;
				continue;
			}
			has_digit = true;
			digits = digits * 10.0 + (text_[at_] - '0');
			exponent -= has_point ? 1 : 0;
			if (digits >= max_digits_value || exponent < -max_exponent) {
				return std::nullopt;
			}
		}
		if (at_ < text_.size() && (text_[at_] == 'e' || text_[at_] == 'E')) {
			++at_;
			const bool is_negative = at_ < text_.size() && text_[at_] == '-';
			at_ += is_negative || (at_ < text_.size() && text_[at_] == '+') ? 1 : 0;
			int written_exponent = 0;
			has_digit = has_digit && at_ < text_.size() && is_digit(text_[at_]);
			for (; at_ < text_.size() && is_digit(text_[at_]); ++at_) {
				written_exponent = std::min(written_exponent * 10 + (text_[at_] - '0'), 1000);
			}
			exponent += is_negative ? -written_exponent : written_exponent;
		}
		if (!has_digit || std::abs(exponent) > max_exponent) {
			return std::nullopt;
		}
		double power = 1.0;
		for (int i = 0; i < std::abs(exponent); ++i) {
			power *= 10.0;
		}
		return exponent < 0 ? digits / power : digits * power;
	}

	bool named() {
		const std::size_t start = at_;
		while (at_ < text_.size() && (is_letter(text_[at_]) || is_digit(text_[at_]))) {
			++at_;
		}
		const std::string_view name = text_.substr(start, at_ - start);
		if (take("(")) {
			if (const auto world = std::ranges::find(world_functions, name, &WorldFunction::name);
					world != world_functions.end()) {
				return call_world(*world, start);
			}
			const auto function = std::ranges::find(functions, name, &Function::name);
			return function != functions.end()
					? call(*function, start)
					: fail_at(start,
							  "there is no function \"" + std::string(name) + "\": the functions are " + function_list);
		}
		const auto channel = std::ranges::find(mask_channel_inputs, name);
		if (channel != mask_channel_inputs.end()) {
			const auto number = static_cast<std::int32_t>(channel - mask_channel_inputs.begin());
			return push_world({.kind = WorldInputKind::mask, .number = number}, start);
		}
		const auto input = std::ranges::find(input_names, name);
		if (input == input_names.end()) {
			const bool is_function = std::ranges::find(functions, name, &Function::name) != functions.end() ||
					std::ranges::find(world_functions, name, &WorldFunction::name) != world_functions.end();
			return fail_at(start,
					is_function ? "expected \"(\" after " + std::string(name)
								: "there is no input \"" + std::string(name) + "\": the inputs are " + input_list);
		}
		return push(
				{.operation = Operation::input, .input = static_cast<ExpressionInput>(input - input_names.begin())});
	}

	bool call(const Function &function, std::size_t start) {
		std::size_t count = 0;
		const bool is_parsed = nested([&] {
			if (take(")")) {
				return true;
			}
			do {
				if (!comparison()) {
					return false;
				}
				++count;
			} while (take(","));
			return close();
		});
		if (!is_parsed) {
			return false;
		}
		if (count != function.arguments) {
			return fail_at(start,
					std::string(function.name) + " must have " + std::to_string(function.arguments) +
							(function.arguments == 1 ? " argument" : " arguments") + ", got " + std::to_string(count));
		}
		if (function.operation == Operation::noise) {
			return make_noise(start);
		}
		apply(function.operation, function.arguments);
		return true;
	}

	/// Appends a world input, or reuses it if the expression already has it.
	bool push_world(const WorldInput &input, std::size_t start) {
		const auto known = std::ranges::find(world_inputs_, input);
		const auto index = static_cast<std::size_t>(known - world_inputs_.begin());
		if (known == world_inputs_.end()) {
			if (index == max_world_inputs) {
				return fail_at(start,
						"too many inputs: an expression may have at most " + std::to_string(max_world_inputs) +
								" biomes, textures, distances and mask channels. Remove some");
			}
			world_inputs_.push_back(input);
		}
		return push({.operation = Operation::world_input, .world_input = static_cast<std::uint8_t>(index)});
	}

	/// Parses the arguments of a world function, after its opening parenthesis.
	bool call_world(const WorldFunction &function, std::size_t start) {
		WorldInput input{.kind = function.kind};
		bool is_valid = false;
		switch (function.kind) {
			case WorldInputKind::biome: is_valid = quoted(input.name) || integer(max_biome_number, input.number); break;
			case WorldInputKind::texture: is_valid = integer(max_input_texture, input.number); break;
			case WorldInputKind::distance:
				is_valid = quoted(input.name) && take(",") && distance(input.max_distance);
				break;
			case WorldInputKind::mask: break; // Channels are inputs without arguments.
		}
		return is_valid && take(")") ? push_world(input, start) : fail_at(start, function.remedy);
	}

	/// Reads a name in double or single quotes that is not empty.
	bool quoted(std::string &r_name) {
		skip_spaces();
		if (at_ == text_.size() || (text_[at_] != '"' && text_[at_] != '\'')) {
			return false;
		}
		const std::size_t end = text_.find(text_[at_], at_ + 1);
		if (end == std::string_view::npos || end == at_ + 1) {
			return false;
		}
		r_name = text_.substr(at_ + 1, end - at_ - 1);
		at_ = end + 1;
		return true;
	}

	/// Reads a constant integer from 0 to `max`.
	bool integer(double max, std::int32_t &r_number) {
		skip_spaces();
		const std::optional<double> value = read_number();
		if (!value.has_value() || !(*value <= max) || *value != std::floor(*value)) {
			return false;
		}
		r_number = static_cast<std::int32_t>(*value);
		return true;
	}

	bool distance(double &r_distance) {
		skip_spaces();
		const std::optional<double> value = read_number();
		r_distance = value.value_or(0.0);
		return r_distance >= min_input_distance && r_distance <= max_input_distance;
	}

	/// Replaces the last value, which must be a constant, by noise of that size.
	bool make_noise(std::size_t start) {
		Step &size = steps_.back();
		if (size.operation != Operation::constant ||
				!(size.number >= min_clump_size && size.number <= max_clump_size)) {
			return fail_at(start, "noise must have a constant size between 0.1 and 100000 m, for example noise(40)");
		}
		size.operation = Operation::noise;
		return true;
	}

	std::string_view text_;
	ExpressionError &error_;
	std::size_t at_ = 0;
	std::size_t depth_ = 0;
	std::size_t nesting_ = 0;
	std::vector<Step> steps_;
	std::vector<WorldInput> world_inputs_;
};

std::shared_ptr<const DensityExpression> DensityExpression::compile(std::string_view text, ExpressionError &r_error) {
	auto expression = std::make_shared<DensityExpression>();
	return ExpressionParser(text, r_error).parse(*expression) ? expression : nullptr;
}

} // namespace thicket
