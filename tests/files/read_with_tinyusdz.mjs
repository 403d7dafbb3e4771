// Prints what TinyUSDZ finds in a USD file, as JSON: the layer as TinyUSDZ prints it once the files that it refers to
// are part of it, and the meshes of its stage. Arguments: the folder of the npm package, the file. Exit code 77: there
// is no TinyUSDZ.
import fs from "node:fs";
import path from "node:path";

const [, , folder, file] = process.argv;
let script, wasm;
try {
  script = fs.readFileSync(path.join(folder, "tinyusdz.js"));
  wasm = fs.readFileSync(path.join(folder, "tinyusdz.wasm"));
} catch {
  process.exit(77);
}

// The package is built for browsers and ends at once where it finds itself under Node, so it must take this for a
// browser's worker. It is a module that does not say so, which older versions of Node believe: hence the address.
process.type = "renderer";
globalThis.WorkerGlobalScope = class {};
globalThis.self = { location: { href: "" } };
console.log = console.error; // it reports there, and only JSON goes out here
const { default: initialize } = await import("data:text/javascript;base64," + script.toString("base64"));
const usd = await initialize({ wasmBinary: wasm, locateFile: (name) => name });

function load(method) {
  const loader = new usd.TinyUSDZLoaderNative();
  if (!loader[method](fs.readFileSync(file), file)) throw loader.error();
  return loader;
}

function compose(layer) {
  for (const asset of layer.extractReferencesAssetPaths())
    layer.setAsset(asset, fs.readFileSync(path.join(path.dirname(file), asset)));
  if (layer.hasReferences() && !layer.composeReferences()) throw layer.error();
}

const found = { error: "", root: "", layer: "", meshes: [] };
try {
  const layer = load("loadAsLayerFromBinary");
  found.root = layer.layerToString();
  compose(layer);
  found.layer = layer.layerToString();
  if (!layer.layerToRenderScene()) throw layer.error();
  for (let i = 0; i < layer.numMeshes(); ++i) {
    const mesh = layer.getMesh(i);
    found.meshes.push({
      path: mesh.absPath,
      points: Array.from(mesh.points),
      normals: Array.from(mesh.normals),
      counts: Array.from(mesh.faceVertexCounts),
      corners: Array.from(mesh.faceVertexIndices),
    });
  }
} catch (error) {
  found.error = String(error);
}
process.stdout.write(JSON.stringify(found));
