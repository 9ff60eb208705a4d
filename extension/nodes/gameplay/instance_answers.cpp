#include "nodes/gameplay/instance_answers.hpp"

#include "nodes/common/script_call.hpp"

#include <godot_cpp/core/error_macros.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// A script's predicate.
class Predicate {
public:
	Predicate(std::string method, const Callable &p_callable, glm::dvec3 offset, SharedLayers layers) :
			method_(std::move(method)), callable_(p_callable), offset_(offset), layers_(std::move(layers)) {}

	bool operator()(const PlacedInstance &instance) {
		if (failed_) {
			return false;
		}
		const Variant id(script_id(instance.id));
		const Variant layer(layers_->at(instance.layer));
		const Variant transform(to_engine(instance, offset_));
		Variant result;
		failed_ = call_script(callable_, "call", result, id, layer, transform) != GDEXTENSION_CALL_OK ||
				result.get_type() != Variant::BOOL;
		if (failed_) {
			const std::string problem = method_ +
					": predicate must take (id: int, layer: ScatterLayer, transform: Transform3D) and return a bool";
			ERR_PRINT(String(problem.c_str()));
		}
		return !failed_ && static_cast<bool>(result);
	}

private:
	std::string method_;
	Variant callable_;
	glm::dvec3 offset_;
	SharedLayers layers_;
	bool failed_ = false;
};

} // namespace

Transform3D to_engine(const PlacedInstance &instance, glm::dvec3 offset) {
	return to_engine(instance.basis, instance.position, offset);
}

AddedInstance to_added(const Transform3D &p_transform, glm::dvec3 offset) {
	AddedInstance added;
	added.position = to_world(p_transform.origin, offset);
	for (int row = 0; row < 3; ++row) {
		const Vector3 &axis = p_transform.basis.rows[row];
		added.basis[0][row] = static_cast<float>(axis.x);
		added.basis[1][row] = static_cast<float>(axis.y);
		added.basis[2][row] = static_cast<float>(axis.z);
	}
	return added;
}

std::function<bool(const PlacedInstance &)> to_predicate(
		std::string method, const Callable &p_predicate, glm::dvec3 offset, SharedLayers layers) {
	if (p_predicate.is_null()) {
		return {};
	}
	const auto predicate = std::make_shared<Predicate>(std::move(method), p_predicate, offset, std::move(layers));
	return [predicate](const PlacedInstance &instance) {
		return (*predicate)(instance);
	};
}

Variant decoded(std::span<const std::uint8_t> bytes) {
	return bytes.empty() ? Variant() : packed_bytes(bytes).decode_var(0, false);
}

} // namespace thicket
