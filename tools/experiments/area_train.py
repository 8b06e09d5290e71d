# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np, torch, sys
torch.set_num_threads(1); torch.manual_seed(0)
names=sys.argv[1:]
D=[np.fromfile(f'./area_{n}.bin',np.float32).reshape(-1,18) for n in names]
for n,d in zip(names,D):
    k=d[:,16]; w=d[:,17]
    print(n,len(d),'kappa mean %.3f sd %.3f max %.3f share0 %.3f'%(k.mean(),k.std(),k.max(),(k<1e-6).mean()),'area-weighted const err',
      [ (c,round(float((np.abs(c-k)*w).sum()/(k*w).sum()),4)) for c in (.4,.5,.6)])
X=np.concatenate([d[:,:16] for d in D]);K=np.concatenate([d[:,16] for d in D]);W=np.concatenate([d[:,17]/d[:,17].mean() for d in D])
ok=np.isfinite(X).all(1)&np.isfinite(K)&(K<=.7501); X,K,W=X[ok],np.clip(K[ok],0,.75),W[ok]
W=np.minimum(W,20)
mu=X.mean(0); sd=X.std(0)+1e-6
perm=np.random.default_rng(0).permutation(len(X)); nv=len(X)//10
Z=torch.tensor((X-mu)/sd); K=torch.tensor(K); W=torch.tensor(W)
va,tr=perm[:nv],perm[nv:]
net=torch.nn.Sequential(torch.nn.Linear(16,16),torch.nn.ReLU(),torch.nn.Linear(16,16),torch.nn.ReLU(),torch.nn.Linear(16,1))
steps=12000; opt=torch.optim.Adam(net.parameters(),3e-3); sch=torch.optim.lr_scheduler.OneCycleLR(opt,1e-2,total_steps=steps)
def f(z): return .75*torch.sigmoid(net(z)[:,0])
for s in range(steps):
    i=torch.tensor(np.random.default_rng(s).choice(tr,512))
    loss=((f(Z[i])-K[i])**2*(.3+W[i])).mean(); opt.zero_grad(); loss.backward(); opt.step(); sch.step()
    if s%2000==1999:
        with torch.no_grad():
            e=(f(Z[va])-K[va]).abs(); print(s+1,'val mean|dk| %.4f weighted area error %.4f'%(e.mean(),(e*W[va]).sum()/(K[va]*W[va]).sum()),flush=True)
P=[p.detach().numpy().astype(np.float64) for p in net.parameters()]
W1=P[0]/sd; b1=P[1]-W1@mu
out=np.concatenate([W1.T.ravel(),b1,P[2].T.ravel(),P[3],P[4].ravel(),P[5].ravel()]).astype(np.float32)
out.tofile('./area.net'); print(len(out))
