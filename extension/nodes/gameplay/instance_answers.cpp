#include "nodes/gameplay/instance_answers.hpp"

#include "nodes/common/convert.hpp"
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

/// A script's predicate. After the first failed call, it rejects all instances.
class Predicate {
public:
	Predicate(std::string method, const Callable &p_callable, const WorldFrame &frame, SharedLayers layers) :
			method_(std::move(method)), callable_(p_callable), frame_(frame), layers_(std::move(layers)) {}

	bool operator()(const PlacedInstance &instance) {
		if (failed_) {
			return false;
		}
		const Variant id(script_id(instance.id));
		const Variant layer(layers_->at(instance.layer));
		const Variant transform(to_engine(instance, frame_));
		Variant result;
		failed_ = call_script(callable_, "call", result, id, layer, transform) != GDEXTENSION_CALL_OK ||
				result.get_type() != Variant::BOOL;
		if (failed_) {
			const std::string problem = method_ +
					": predicate must take (id: int, layer: ScatterLayer, transform: Transform3D) and return a bool. "
					"The call failed or returned another type, so no more instances match.";
			ERR_PRINT(String(problem.c_str()));
		}
		return !failed_ && static_cast<bool>(result);
	}

private:
	std::string method_;
	Variant callable_;
	WorldFrame frame_;
	SharedLayers layers_;
	bool failed_ = false;
};

} // namespace

Transform3D to_engine(const PlacedInstance &instance, const WorldFrame &frame) {
	return to_engine(instance.basis, instance.position, frame);
}

AddedInstance to_added(const Transform3D &p_transform, const WorldFrame &frame) {
	AddedInstance added;
	added.position = to_world(p_transform.origin, frame);
	added.basis = glm::mat3(frame.rotated(to_core(p_transform.basis)));
	return added;
}

std::function<bool(const PlacedInstance &)> to_predicate(
		std::string method, const Callable &p_predicate, const WorldFrame &frame, SharedLayers layers) {
	if (p_predicate.is_null()) {
		return {};
	}
	const auto predicate = std::make_shared<Predicate>(std::move(method), p_predicate, frame, std::move(layers));
	return [predicate](const PlacedInstance &instance) {
		return (*predicate)(instance);
	};
}

Variant decoded(std::span<const std::uint8_t> bytes) {
	return bytes.empty() ? Variant() : packed_bytes(bytes).decode_var(0, false);
}

} // namespace thicket
