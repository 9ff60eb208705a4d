#pragma once

#include "core/rules/density_expression.hpp"

#include <godot_cpp/variant/string.hpp>

#include <memory>
#include <string>

namespace thicket {

using SharedExpression = std::shared_ptr<const DensityExpression>;

/// Compiles the text of a property, such as "ScatterLayer.density_expression". A blank text sets
/// `r_expression` to null. If the text is unchanged, `r_expression` keeps its object. If the text
/// is invalid, prints an error, returns false and leaves `r_expression` unchanged.
bool compile_text(const std::string &property, const godot::String &p_text, SharedExpression &r_expression);

/// Returns the text of an expression, or an empty text for null.
godot::String text_of(const SharedExpression &expression);

} // namespace thicket
