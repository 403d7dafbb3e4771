// The one place where tinygltf is compiled.
#define TINYGLTF_IMPLEMENTATION
#include "files/tiny_gltf.h"
