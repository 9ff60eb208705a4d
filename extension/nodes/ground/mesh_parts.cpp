#include "nodes/ground/mesh_parts.hpp"

#include "core/base/guard.hpp"
#include "core/base/progress.hpp"
#include "core/base/split_mix.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/ground/changed_areas.hpp"

#include <glm/matrix.hpp>

#include <algorithm>
#include <bit>
#include <span>
#include <utility>

namespace thicket {

namespace {

std::uint64_t digest_of(std::span<const glm::dvec3> corners) {
	std::uint64_t digest = corners.size();
	for (const glm::dvec3 &corner : corners) {
		for (const double coordinate : {corner.x, corner.y, corner.z}) {
			digest = split_mix(digest + split_mix_gamma) ^ std::bit_cast<std::uint64_t>(coordinate);
		}
	}
	return digest;
}

/// Adds the areas in which the ground differs between `before` and `after` to `r_areas`.
void add_changes(const GroundMeshes &before, const GroundMeshes &after, std::vector<Rect> &r_areas) {
	const auto add_differences = [&](const GroundMeshes &meshes, const GroundMeshes &others) {
		for (const auto &[id, mesh] : meshes) {
			const auto other = others.find(id);
			if (other == others.end() || other->second->digest != mesh->digest) {
				add_changed_area(r_areas, area_of(*mesh));
			}
		}
	};
	add_differences(before, after);
	add_differences(after, before);
}

} // namespace

Rect area_of(const GroundMesh &mesh) {
	const Box3 &bounds = mesh.ground->bounds();
	return {{bounds.min.x, bounds.min.z}, {bounds.max.x, bounds.max.z}};
}

void MeshReading::build(std::span<const glm::vec3> faces, const std::atomic<bool> *cancel) {
	status = guarded("corners", static_cast<double>(faces.size()), [&] {
		const glm::dmat3 basis = to_core(state.frame.basis);
		const glm::dvec3 origin = to_core(state.frame.origin) + space.offset;
		std::vector<glm::dvec3> corners;
		corners.reserve(faces.size());
		for (const glm::vec3 &corner : faces) {
			corners.push_back(origin + basis * glm::dvec3(corner));
		}
		auto result = std::make_shared<GroundMesh>();
		result->state = state;
		result->space = space;
		result->copy = copy;
		result->digest = digest_of(corners);
		result->planet = planet;
		for (std::size_t i = 0; planet.exists() && i + 2 < corners.size(); i += 3) {
			result->shell.add(
					corners[i] - planet.center, corners[i + 1] - planet.center, corners[i + 2] - planet.center);
		}
		if (before != nullptr && before->digest == result->digest) {
			// The triangles are unchanged.
			result->ground = before->ground;
		} else {
			auto ground = std::make_shared<TriangleTerrain>();
			// The engine swaps the sides of a mirrored mesh.
			const Winding winding = glm::determinant(basis) < 0.0 ? Winding::counterclockwise : Winding::clockwise;
			if (const Status error = ground->set(corners, cancel, winding); !error.ok()) {
				const std::size_t corner = TriangleTerrain::find_refused_corner(corners);
				refused_corner = corner < corners.size() ? corners[corner] : glm::dvec3(0.0);
				return error;
			}
			result->ground = std::move(ground);
		}
		mesh = std::move(result);
		return Status{};
	});
}

void MeshWork::run(const std::atomic<bool> *cancel) {
	unneeded_objects.clear();
	build_readings(cancel);
	for (GroundWorld &world : worlds) {
		if (!is_cancelled(cancel)) {
			update(world);
		}
	}
}

/// Builds the ground of all meshes that were read.
void MeshWork::build_readings(const std::atomic<bool> *cancel) {
	std::ranges::stable_sort(readings, {}, &MeshReading::copy); // To decode each mesh once.
	std::vector<glm::vec3> faces;
	const MeshCopy *decoded_copy = nullptr;
	Status status;
	for (MeshReading &reading : readings) {
		if (is_cancelled(cancel)) {
			return;
		}
		if (reading.copy.get() != decoded_copy) {
			faces.clear();
			decoded_copy = reading.copy.get();
			status = guarded("faces", 0.0, [&] { return reading.copy->append_faces(faces); });
		}
		reading.status = status;
		if (status.ok()) {
			reading.build(faces, cancel);
		}
	}
}

/// Updates a world's ground with the built meshes. Rejected meshes keep their previous ground.
void MeshWork::update(GroundWorld &r_world) const {
	r_world.changes.clear();
	r_world.status = guarded("parts", static_cast<double>(r_world.meshes->size()), [&] {
		auto meshes = std::make_shared<GroundMeshes>(*r_world.meshes);
		for (const std::uint64_t id : removed_ids) {
			meshes->erase(id);
		}
		for (const MeshReading &reading : readings) {
			if (reading.mesh != nullptr && reading.space == r_world.space) {
				(*meshes)[reading.id] = reading.mesh;
			}
		}
		std::vector<Rect> changes;
		add_changes(*r_world.meshes, *meshes, changes);
		auto ground = r_world.ground;
		if (ground == nullptr || !changes.empty()) {
			std::vector<TriangleParts::Part> grounds;
			grounds.reserve(meshes->size());
			for (const auto &[id, mesh] : *meshes) {
				grounds.push_back(mesh->ground);
			}
			auto new_ground = std::make_shared<TriangleParts>();
			if (const Status status = new_ground->set(grounds); !status.ok()) {
				return status;
			}
			ground = std::move(new_ground);
		}
		r_world.meshes = std::move(meshes);
		r_world.ground = std::move(ground);
		r_world.changes = std::move(changes);
		return Status{};
	});
}

} // namespace thicket
