// Plays a glTF file as three.js does and prints what it shows at some times, as JSON: the meshes of nodes that have a size,
// with vertices and normals in the world, morph targets and all. Arguments: the folder of the npm package, the times in
// seconds with commas between, the file. Exit code 77: there is no three.js.
import fs from "node:fs";
import path from "node:path";
import { pathToFileURL } from "node:url";

const [, , folder, times, file] = process.argv;
const module = (name) => import(pathToFileURL(path.join(folder, name)));
if (!fs.existsSync(path.join(folder, "package.json"))) process.exit(77);
const THREE = await module("build/three.module.js");
const { GLTFLoader } = await module("examples/jsm/loaders/GLTFLoader.js");
const { MeshoptDecoder } = await module("examples/jsm/libs/meshopt_decoder.module.js");

/// A normal of a mesh's own, as its vertex shader adds the morph targets up.
function normalOf(mesh, v) {
  const { attributes, morphAttributes } = mesh.geometry;
  const normal = new THREE.Vector3().fromBufferAttribute(attributes.normal, v);
  (morphAttributes.normal ?? []).forEach((target, t) => {
    const weight = mesh.morphTargetInfluences[t];
    if (weight !== 0) normal.addScaledVector(new THREE.Vector3().fromBufferAttribute(target, v), weight);
  });
  return normal;
}

function shownMesh(mesh) {
  const turn = new THREE.Matrix3().getNormalMatrix(mesh.matrixWorld);
  const { attributes, index } = mesh.geometry;
  const vertices = [], normals = [], place = new THREE.Vector3();
  for (let v = 0; v < attributes.position.count; ++v) {
    vertices.push(...mesh.getVertexPosition(v, place).applyMatrix4(mesh.matrixWorld));
    normals.push(...normalOf(mesh, v).applyNormalMatrix(turn));
  }
  const { name: material, color } = mesh.material;
  return { name: mesh.userData.name, material, color: color.toArray(), vertices, normals, corners: Array.from(index.array) };
}

const bytes = fs.readFileSync(file);
const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);
const { scene, animations } = await loader.parseAsync(new Uint8Array(bytes).buffer, "");
const mixer = new THREE.AnimationMixer(scene);
for (const clip of animations) {
  const action = mixer.clipAction(clip).setLoop(THREE.LoopOnce);
  action.clampWhenFinished = true; // the last key is shown too
  action.play();
}
const found = { durations: animations.map((clip) => clip.duration), shown: [] };
for (const time of times.split(",").map(Number)) {
  mixer.setTime(time);
  scene.traverse((node) => { node.visible = node.scale.x !== 0; });
  scene.updateMatrixWorld(true);
  const meshes = [];
  scene.traverseVisible((node) => { if (node.isMesh) meshes.push(shownMesh(node)); });
  found.shown.push({ time, meshes });
}
process.stdout.write(JSON.stringify(found));
