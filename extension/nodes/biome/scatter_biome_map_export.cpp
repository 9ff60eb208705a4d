// This file prepares biome maps for dedicated server exports, which replace textures with
// placeholders.

#include "nodes/biome/scatter_biome_map.hpp"
#include "nodes/common/stripped.hpp"
#include "nodes/ground/image_posts.hpp"

#include <godot_cpp/classes/texture2d.hpp>

using namespace godot;

namespace thicket {

String ScatterBiomeMap::stripped_problem() const {
	return is_stripped(image_) ? thicket::stripped_problem("ScatterBiomeMap.map_image", "there is no biome anywhere")
							   : String();
}

bool ScatterBiomeMap::embed_stripped_data() {
	const Ref<Texture2D> texture = image_;
	const Ref<Image> image = texture.is_valid() ? texture->get_image() : Ref<Image>();
	const bool has_pixels = has_content(image);
	if (has_pixels) {
		set_map_image(image);
	}
	return has_pixels;
}

} // namespace thicket
