// Passes an asset through what glTF-Transform does to files: gltf_transform.mjs IN.glb copy|weld|reorder|prune OUT.glb
// NODE_MODULES: the folder that npm has installed it in.
import { createRequire } from 'node:module';
import { pathToFileURL } from 'node:url';

const [, , input, step, output] = process.argv;
const modules = createRequire(process.env.NODE_MODULES + '/');
const load = async (name) => import(pathToFileURL(modules.resolve(name)).href);
const { NodeIO } = await load('@gltf-transform/core');
const { weld, reorder, prune, dedup } = await load('@gltf-transform/functions');
const { ALL_EXTENSIONS } = await load('@gltf-transform/extensions');
const { MeshoptEncoder } = await load('meshoptimizer');
await MeshoptEncoder.ready;

const io = new NodeIO().registerExtensions(ALL_EXTENSIONS);
const document = await io.read(input);
const steps = { copy: [], weld: [weld()], reorder: [reorder({ encoder: MeshoptEncoder })], prune: [dedup(), prune()] };
await document.transform(...steps[step]);
await io.write(output, document);
