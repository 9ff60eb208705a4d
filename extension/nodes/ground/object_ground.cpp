#include "nodes/ground/object_ground.hpp"

#include "core/terrain/slope_stencil.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/common/script_call.hpp"
#include "nodes/ground/given_normal.hpp"

#include <godot_cpp/classes/object.hpp>
#include <godot_cpp/variant/vector3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

using namespace godot;

namespace thicket {

namespace {

/// The number of positions to sample each time the gate is entered.
constexpr std::size_t positions_per_slice = 64;

constexpr const char *node_property = "ScatterGroundNode.node";

/// Returns the total weight of `textures`, given the result of get_texture_id().
float weight_of(const Vector3 &p_base_overlay_blend, std::span<const std::int32_t> textures) {
	const auto is_selected = [textures](real_t texture) {
		return std::ranges::any_of(textures, [texture](std::int32_t selected) { return texture == real_t(selected); });
	};
	// Preserves NAN.
	const float blend = std::clamp(static_cast<float>(p_base_overlay_blend.z), 0.0F, 1.0F);
	const float weight = (is_selected(p_base_overlay_blend.x) ? 1.0F - blend : 0.0F) +
			(is_selected(p_base_overlay_blend.y) ? blend : 0.0F);
	return std::isfinite(weight) ? weight : 0.0F;
}

} // namespace

std::shared_ptr<ObjectGround> ObjectGround::of(const Variant &p_object, const GroundLimits &limits) {
	auto ground = std::make_shared<ObjectGround>();
	ground->limits_ = limits;
	if (ground->take_methods(p_object)) {
		ground->take_post_grid();
		return ground->posts_ == nullptr || ground->posts_->spacing > 0.0 ? ground : nullptr;
	}
	Object *object = p_object.get_validated_object();
	// Keeps the data alive, because it may have no other owner.
	const Variant data = object != nullptr ? object->get("data") : Variant();
	return ground->take_methods(data) || ground->take_map(p_object) ? ground : nullptr;
}

std::shared_ptr<ObjectGround> ObjectGround::at_offset(glm::dvec3 offset) const {
	auto ground = std::make_shared<ObjectGround>();
	ground->source_ = source_;
	ground->height_method_ = height_method_;
	ground->has_normal_ = has_normal_;
	ground->has_textures_ = has_textures_;
	ground->map_ = map_;
	ground->posts_ = posts_;
	ground->limits_ = limits_;
	ground->offset_ = offset;
	return ground;
}

bool ObjectGround::take_methods(const Variant &p_object) {
	if (!has_method(p_object, height_method_)) {
		return false;
	}
	source_ = p_object;
	has_normal_ = has_method(p_object, normal_method_);
	has_textures_ = has_method(p_object, texture_method_);
	return true;
}

/// Uses the methods of an HTerrain-like object and reads its map. Returns false for other objects.
bool ObjectGround::take_map(const Variant &p_object) {
	if (!has_method(p_object, "get_data") || !has_method(p_object, "get_internal_transform")) {
		return false;
	}
	const Variant data = result_of(p_object, "get_data");
	if (!has_method(data, "get_interpolated_height_at") || !has_method(data, "get_resolution")) {
		return false;
	}
	map_ = read_map(p_object, data);
	source_ = data;
	height_method_ = "get_interpolated_height_at";
	return map_ != nullptr;
}

void ObjectGround::take_post_grid() {
	if (is_post_grid(source_)) {
		posts_ = std::make_shared<PostGridArea>(PostGridArea::of(source_));
		has_normal_ = false; // get_normal() of MTerrain is imprecise and crashes at the border.
	}
}

void ObjectGround::set_offset(glm::dvec3 offset) {
	if (map_ == nullptr) {
		gate_.run_alone([this, offset] { offset_ = offset; });
	}
}

void ObjectGround::close() {
	is_open_ = false;
	gate_.run_alone([] {});
}

Status ObjectGround::sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const {
	return sample_all(positions, true, r_ground);
}

Status ObjectGround::sample_heights(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const {
	return sample_all(positions, false, r_ground);
}

/// Samples the positions in slices, so that `close` waits for at most one slice of each thread.
Status ObjectGround::sample_all(
		std::span<const glm::dvec2> positions, bool with_normals, std::span<Ground> r_ground) const {
	if (positions.size() != r_ground.size()) {
		return Status::wrong_size("ground", r_ground.size(), exactly(positions.size()));
	}
	for (std::size_t first = 0; first < positions.size(); first += positions_per_slice) {
		const std::size_t count = std::min(positions_per_slice, positions.size() - first);
		const CallGate::Scope scope(gate_);
		const Status status =
				sample_slice(positions.subspan(first, count), with_normals, r_ground.subspan(first, count));
		if (!status.ok()) {
			return status;
		}
	}
	return {};
}

Status ObjectGround::sample_slice(
		std::span<const glm::dvec2> positions, bool with_normals, std::span<Ground> r_ground) const {
	for (std::size_t i = 0; i < positions.size(); ++i) {
		if (const Status status = ground_at(positions[i], with_normals, r_ground[i]); !status.ok()) {
			return status;
		}
	}
	return {};
}

Status ObjectGround::ground_at(glm::dvec2 position, bool with_normal, Ground &r_ground) const {
	r_ground = {};
	Status status = height_at(position, r_ground.height);
	if (with_normal && status.ok() && std::isfinite(r_ground.height)) {
		status = has_normal_ ? normal_at(position, r_ground) : slope_by_heights(position, r_ground);
	}
	return status;
}

/// Tests both the exact position and the rounded position that is passed to the object, because
/// rounding may move a position to the far edge.
bool ObjectGround::within_bounds(glm::dvec2 position) const {
	const glm::dvec2 query_position = glm::dvec2(glm::vec2(in_engine(position))) + glm::dvec2(offset_.x, offset_.z);
	return limits_.bounds.empty() || (limits_.bounds.contains(position) && limits_.bounds.contains(query_position));
}

bool ObjectGround::is_height_known(glm::dvec2 position) const {
	if (!posts_) {
		return true;
	}
	const CallGate::Scope scope(gate_);
	const glm::dvec2 query_position = in_engine(position);
	return !posts_->contains(query_position) ||
			(is_open_ && source() != nullptr && posts_->is_loaded(source_, query_position));
}

/// Reads the height at a position; NAN if there is no ground. Calls the object only within its ground.
Status ObjectGround::height_at(glm::dvec2 position, float &r_height) const {
	r_height = std::numeric_limits<float>::quiet_NaN();
	const glm::dvec2 query_position = map_ ? map_->to_map(in_engine(position)) : in_engine(position);
	const bool is_inside = (!map_ || map_->has_ground(query_position)) && (!posts_ || posts_->contains(query_position));
	if (!std::isfinite(query_position.x) || !std::isfinite(query_position.y) || !is_inside ||
			!within_bounds(position)) {
		return {};
	}
	if (!is_height_known(position)) {
		return {};
	}
	Variant result;
	if (const Status status = call(
				height_method_, "result of the height method of ScatterGroundNode.node", query_position, result);
			!status.ok()) {
		return status;
	}
	if (!is_number(result)) {
		return Status::wrong_type("result of the height method of ScatterGroundNode.node", "Return a float");
	}
	const auto height = static_cast<double>(result);
	if (limits_.no_ground == static_cast<float>(height)) {
		return {};
	}
	r_height = static_cast<float>((map_ ? map_->height_in_world(height) : height) + offset_.y);
	return {};
}

/// Computes the normal from the heights of four neighboring positions.
Status ObjectGround::slope_by_heights(glm::dvec2 position, Ground &r_ground) const {
	const SlopeStencil stencil(position);
	std::array<float, 4> neighbor_heights{};
	for (std::size_t i = 0; i < neighbor_heights.size(); ++i) {
		if (const Status status = height_at(stencil.positions()[i], neighbor_heights[i]); !status.ok()) {
			return status;
		}
	}
	r_ground.normal = stencil.normal(r_ground.height, neighbor_heights);
	return {};
}

/// Reads the normal from the object's `get_normal`.
Status ObjectGround::normal_at(glm::dvec2 position, Ground &r_ground) const {
	Variant result;
	if (const Status status = call(
				normal_method_, "result of get_normal() of ScatterGroundNode.node", in_engine(position), result);
			!status.ok()) {
		return status;
	}
	if (result.get_type() != Variant::VECTOR3) {
		return Status::wrong_type("result of get_normal() of ScatterGroundNode.node", "Return a Vector3");
	}
	set_normal(static_cast<Vector3>(result), r_ground);
	return {};
}

Status ObjectGround::weigh(std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures,
		std::span<Ground> r_ground) const {
	if (positions.size() != r_ground.size()) {
		return Status::wrong_size("ground", r_ground.size(), exactly(positions.size()));
	}
	const std::vector<unsigned> channels = map_ ? map_->channels_of(textures) : std::vector<unsigned>();
	for (std::size_t i = 0; i < positions.size(); ++i) {
		if (!std::isfinite(r_ground[i].height)) {
			continue; // Some plugins crash for positions outside their ground.
		}
		if (map_) {
			r_ground[i].weight = map_->weight(map_->to_map(in_engine(positions[i])), channels);
		} else if (has_textures_) {
			const CallGate::Scope scope(gate_);
			if (const Status status = weigh_by_textures(positions[i], textures, r_ground[i]); !status.ok()) {
				return status;
			}
		}
	}
	return {};
}

/// Computes the weight from the result of the object's `get_texture_id`.
Status ObjectGround::weigh_by_textures(
		glm::dvec2 position, std::span<const std::int32_t> textures, Ground &r_ground) const {
	Variant result;
	if (const Status status = call(
				texture_method_, "result of get_texture_id() of ScatterGroundNode.node", in_engine(position), result);
			!status.ok()) {
		return status;
	}
	if (result.get_type() != Variant::VECTOR3) {
		return Status::wrong_type("result of get_texture_id() of ScatterGroundNode.node",
				"Return a Vector3 of base texture, overlay texture and blend");
	}
	r_ground.weight = weight_of(static_cast<Vector3>(result), textures);
	return {};
}

Status ObjectGround::call(
		const StringName &p_method, const char *p_property, glm::dvec2 position, Variant &r_result) const {
	if (!is_open_ || source() == nullptr) {
		return Status::missing(node_property, "Set ScatterGroundNode.node to a node in the tree");
	}
	const Variant argument(to_engine(glm::dvec3(position.x, 0.0, position.y)));
	Variant source(source_);
	const bool succeeded = call_script(source, p_method, r_result, argument) == GDEXTENSION_CALL_OK;
	return succeeded ? Status{} : Status::missing(p_property, "See the error that the script printed");
}

} // namespace thicket
