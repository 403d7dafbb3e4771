// Prints what Khronos' validator says of a glTF file, as JSON: counts of errors and warnings, and the messages.
// Arguments: the folder of the npm package, the file. Exit code 77: there is no validator.
import fs from "node:fs";
import { createRequire } from "node:module";

const [, , folder, file] = process.argv;
let validator;
try {
  validator = createRequire(import.meta.url)(folder);
} catch {
  process.exit(77);
}
const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)));
const { numErrors, numWarnings, messages } = report.issues;
process.stdout.write(JSON.stringify({ errors: numErrors, warnings: numWarnings, messages, info: report.info }));
