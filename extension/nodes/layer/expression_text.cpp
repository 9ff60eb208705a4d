#include "nodes/layer/expression_text.hpp"

#include <godot_cpp/core/error_macros.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <algorithm>
#include <utility>

using namespace godot;

namespace thicket {

bool compile_text(const std::string &property, const String &p_text, SharedExpression &r_expression) {
	std::string text = p_text.utf8().get_data();
	const std::size_t end = text.find_last_not_of(" \t\n") + 1;
	text = text.substr(0, end).substr(std::min(end, text.find_first_not_of(" \t\n")));
	if (text == (r_expression == nullptr ? std::string() : r_expression->text())) {
		return true;
	}
	if (text.empty()) {
		r_expression = nullptr;
		return true;
	}
	ExpressionError error;
	SharedExpression compiled = DensityExpression::compile(text, error);
	if (compiled == nullptr) {
		ERR_PRINT(vformat("%s: \"%s\", column %d: %s. The last valid value is kept.", String::utf8(property.c_str()),
				String::utf8(text.c_str()), static_cast<int64_t>(error.column), String::utf8(error.message.c_str())));
		return false;
	}
	r_expression = std::move(compiled);
	return true;
}

String text_of(const SharedExpression &expression) {
	return expression == nullptr ? String() : String::utf8(expression->text().c_str());
}

} // namespace thicket
