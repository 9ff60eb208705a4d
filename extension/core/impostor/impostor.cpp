#include "core/impostor/impostor.hpp"

#include "core/base/check.hpp"
#include "core/base/guard.hpp"
#include "core/impostor/frame_levels.hpp"
#include "core/impostor/frame_raster.hpp"
#include "core/impostor/impostor_atlas.hpp"
#include "core/impostor/srgb.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <cmath>
#include <cstddef>
#include <utility>

namespace thicket {

namespace {

Status check_surfaces(std::span<const ImpostorSurface> surfaces) {
	std::size_t indices = 0;
	for (const ImpostorSurface &surface : surfaces) {
		if (const Status status = surface.check(); !status.ok()) {
			return status;
		}
		indices += surface.indices.size();
	}
	return indices == 0 ? Status{ErrorCode::missing, "surfaces"} : Status();
}

/// Computes the bounding box and the bounding sphere of the corners of all triangles.
void measure(std::span<const ImpostorSurface> surfaces, Impostor &r_impostor) {
	bool is_first = true;
	const auto for_each_corner = [&](auto &&visit) {
		for (const ImpostorSurface &surface : surfaces) {
			for (const std::uint32_t index : surface.indices) {
				visit(surface.positions[index]);
			}
		}
	};
	for_each_corner([&](const glm::vec3 &corner) {
		r_impostor.min = is_first ? corner : glm::min(r_impostor.min, corner);
		r_impostor.max = is_first ? corner : glm::max(r_impostor.max, corner);
		is_first = false;
	});
	r_impostor.center = (r_impostor.min + r_impostor.max) * 0.5F;
	float squared_radius = 0.0F;
	for_each_corner([&](const glm::vec3 &corner) {
		const glm::vec3 offset = corner - r_impostor.center;
		squared_radius = glm::max(squared_radius, glm::dot(offset, offset));
	});
	r_impostor.radius = std::sqrt(squared_radius);
}

/// Returns the colors by which the texture of a surface is multiplied, one per vertex.
std::vector<glm::vec4> tints_of(const ImpostorSurface &surface) {
	const ImpostorMaterial &material = surface.material;
	std::vector<glm::vec4> tints(surface.positions.size(), material.albedo);
	if (material.vertex_colors == VertexColors::unused || surface.colors.empty()) {
		return tints;
	}
	const SrgbCurve &curve = SrgbCurve::get();
	for (std::size_t vertex = 0; vertex < tints.size(); ++vertex) {
		glm::vec4 color = surface.colors[vertex];
		if (material.vertex_colors == VertexColors::srgb) {
			color = {curve.linear(color.r), curve.linear(color.g), curve.linear(color.b), color.a};
		}
		tints[vertex] *= color;
	}
	return tints;
}

Status render_frames(std::span<const ImpostorSurface> surfaces, const Progress &progress, Impostor &r_impostor) {
	const ImpostorSettings &settings = r_impostor.settings;
	std::vector<std::vector<glm::vec4>> tints;
	for (const ImpostorSurface &surface : surfaces) {
		tints.push_back(tints_of(surface));
	}
	FrameRaster raster(settings.frame_size * settings.samples);
	FrameLevels frame(settings.frame_size);
	ImpostorAtlas atlas(settings);
	const int count = settings.frames * settings.frames;
	for (int index = 0; index < count; ++index) {
		if (progress.cancelled()) {
			return {ErrorCode::cancelled, "impostor"};
		}
		const int column = index % settings.frames;
		const int row = index / settings.frames;
		const glm::vec2 position = glm::vec2(static_cast<float>(2 * column), static_cast<float>(2 * row)) /
						static_cast<float>(settings.frames - 1) -
				1.0F;
		const FrameView view{view_axes(octahedral_direction(position, settings.span)), r_impostor.center,
				r_impostor.radius, settings.samples};
		raster.clear();
		for (std::size_t surface = 0; surface < surfaces.size(); ++surface) {
			raster.draw(surfaces[surface], tints[surface], view);
		}
		frame.compute(raster);
		atlas.put(column, row, frame);
		if (progress.report) {
			progress.report(static_cast<double>(index + 1) / count, static_cast<std::uint64_t>(index) + 1);
		}
	}
	atlas.finish();
	r_impostor.albedo = std::move(atlas.albedo());
	r_impostor.normal = std::move(atlas.normal());
	return {};
}

} // namespace

Status validate(const ImpostorSettings &settings) {
	const Status status =
			first_failure(check_range("frames", settings.frames, min_impostor_frames, max_impostor_frames),
					check_range("frame_size", settings.frame_size, min_frame_size, max_frame_size),
					check_range("samples", settings.samples, 1.0, max_impostor_samples));
	if (status.ok() && (settings.frame_size & (settings.frame_size - 1)) != 0) {
		return Status::out_of_range("frame_size", settings.frame_size,
				between(min_frame_size, max_frame_size, "a power of two"), "Use 64, 128 or 256");
	}
	const int side = settings.frames * settings.frame_size;
	return status.ok() && side > max_atlas_side
			? Status::out_of_range("frames", settings.frames,
					  at_most(max_atlas_side / settings.frame_size, "for an atlas of this frame_size"),
					  "Lower frames or frame_size")
			: status;
}

Status bake_impostor(std::span<const ImpostorSurface> surfaces, const ImpostorSettings &settings,
		const Progress &progress, Impostor &r_impostor) {
	if (const Status status = first_failure(validate(settings), check_surfaces(surfaces)); !status.ok()) {
		return status;
	}
	return guarded("impostor", static_cast<double>(settings.frames) * settings.frame_size, [&]() -> Status {
		Impostor result;
		result.settings = settings;
		measure(surfaces, result);
		if (!(result.radius > 0.0F)) {
			return {ErrorCode::not_positive, "radius", result.radius, {}, {}, "Use surfaces that have a size above 0"};
		}
		const Status status = render_frames(surfaces, progress, result);
		if (status.ok()) {
			r_impostor = std::move(result);
		}
		return status;
	});
}

} // namespace thicket
