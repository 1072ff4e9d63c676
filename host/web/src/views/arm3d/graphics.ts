// Lets the page do all else while a view is made and while the graphics processor works: neither may hold the page up.

const LOOK_EVERY_MS = 10;

/** Ends this task of the page; what waits comes first. */
export function pause(ms = 0): Promise<void> {
  return new Promise((resolve) => setTimeout(resolve, ms));
}

/** The context of a canvas, null where the browser lacks or forbids it. Edges are smooth where a graphics processor draws. */
export function contextOf(canvas: HTMLCanvasElement): WebGL2RenderingContext | null {
  try {
    const antialias = !isSoftware(document.createElement("canvas").getContext("webgl2"));
    return canvas.getContext("webgl2", { antialias, alpha: true, stencil: true });
  } catch {
    return null;
  }
}

/** True if the computer's own processor draws, for which each pixel costs time. */
function isSoftware(context: WebGL2RenderingContext | null): boolean {
  const names = context?.getExtension("WEBGL_debug_renderer_info");
  const renderer = names ? String(context!.getParameter(names.UNMASKED_RENDERER_WEBGL)) : "";
  context?.getExtension("WEBGL_lose_context")?.loseContext(); // a browser has few of them
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(renderer);
}

/** Waits until the graphics processor has done all that it was told, or is lost. */
export async function finished(context: WebGL2RenderingContext): Promise<void> {
  const fence = context.fenceSync(context.SYNC_GPU_COMMANDS_COMPLETE, 0);
  if (!fence) return;
  context.flush();
  while (!context.isContextLost() && context.getSyncParameter(fence, context.SYNC_STATUS) === context.UNSIGNALED) {
    await pause(LOOK_EVERY_MS);
  }
  context.deleteSync(fence);
}
