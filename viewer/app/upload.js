import { Problem, problemFromText } from '../core/problem.js';

/**
 * Sends a file; onProgress(fraction) while its bytes leave. Resolves to the volume document.
 * By XMLHttpRequest, because fetch does not tell how far an upload is.
 */
export function uploadFile(url, headers, file, onProgress) {
  return new Promise((resolve, reject) => {
    const request = new XMLHttpRequest();
    request.open('POST', url);
    for (const [name, value] of Object.entries({ ...headers, 'Content-Type': 'application/octet-stream' })) {
      request.setRequestHeader(name, value);
    }
    request.upload.onprogress = ({ loaded, total }) => onProgress(total > 0 ? loaded / total : 0);
    request.onerror = () => reject(new Problem({ detail: 'The upload was interrupted.', code: 'unavailable' }));
    request.onload = () => {
      if (request.status >= 200 && request.status < 300) resolve(JSON.parse(request.responseText));
      else reject(problemFromText(request.status, request.responseText));
    };
    request.send(file);
  });
}
