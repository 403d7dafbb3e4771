#pragma once

// tinygltf without pictures, which no file here has. Its names get one of ours, so that an application which
// brings a tinygltf of its own can link mallow too.
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define tinygltf mallow_tinygltf
#include <tiny_gltf.h>
#undef tinygltf
