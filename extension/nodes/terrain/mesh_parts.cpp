#include "nodes/terrain/mesh_parts.hpp"

#include "core/base/guard.hpp"
#include "core/base/split_mix.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/common/threads.hpp"
#include "nodes/terrain/changed_areas.hpp"

#include <godot_cpp/classes/worker_thread_pool.hpp>

#include <bit>
#include <span>
#include <utility>

using namespace godot;

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

} // namespace

bool add_changes(const GroundMeshes &before, const GroundMeshes &now, std::vector<Rect> &r_areas) {
	bool differs = false;
	const auto add_others = [&](const GroundMeshes &parts, const GroundMeshes &others) {
		for (const auto &[id, part] : parts) {
			const auto other = others.find(id);
			if (other == others.end() || other->second->digest != part->digest) {
				add_changed_area(r_areas, part->ground->area());
				differs = true;
			}
		}
	};
	add_others(before, now);
	add_others(now, before);
	return differs;
}

void MeshReading::build() {
	status = guarded("corners", static_cast<double>(faces.size()), [this] {
		const glm::dmat3 basis = to_core(sight.frame.basis);
		const glm::dvec3 origin = to_world(sight.frame.origin, offset);
		std::vector<glm::dvec3> corners;
		corners.reserve(static_cast<std::size_t>(faces.size()));
		for (const Vector3 &corner : std::span(faces.ptr(), static_cast<std::size_t>(faces.size()))) {
			corners.push_back(origin + basis * to_core(corner));
		}
		auto made = std::make_shared<GroundMesh>();
		made->sight = sight;
		made->offset = offset;
		made->digest = digest_of(corners);
		if (before != nullptr && before->digest == made->digest) {
			// Fast path: its corners are where they were.
			made->ground = before->ground;
		} else {
			auto ground = std::make_shared<TriangleTerrain>();
			if (const Status refused = ground->set(corners); !refused.ok()) {
				return refused;
			}
			made->ground = std::move(ground);
		}
		part = std::move(made);
		return Status{};
	});
}

void MeshBuilder::start(std::vector<MeshReading> readings) {
	readings_ = std::move(readings);
	cancelled_ = false;
	busy_ = true;
	if (has_threads()) {
		task_ = WorkerThreadPool::get_singleton()->add_native_task(&MeshBuilder::run, this, false, "Thicket ground");
	} else {
		run(this);
	}
}

void MeshBuilder::run(void *p_builder) {
	auto &builder = *static_cast<MeshBuilder *>(p_builder);
	for (MeshReading &reading : builder.readings_) {
		if (builder.cancelled_) {
			return;
		}
		reading.build();
	}
}

bool MeshBuilder::finish() {
	if (!busy_ || (task_ >= 0 && !WorkerThreadPool::get_singleton()->is_task_completed(task_))) {
		return false;
	}
	if (task_ >= 0) {
		WorkerThreadPool::get_singleton()->wait_for_task_completion(
				task_); // It is; this makes the pool forget the task.
		task_ = -1;
	}
	busy_ = false;
	return true;
}

std::vector<MeshReading> MeshBuilder::take() { return std::exchange(readings_, {}); }

void MeshBuilder::cancel() {
	cancelled_ = true;
	if (task_ >= 0) {
		WorkerThreadPool::get_singleton()->wait_for_task_completion(task_);
		task_ = -1;
	}
	busy_ = false;
	readings_.clear();
}

} // namespace thicket
